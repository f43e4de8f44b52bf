// A few threads that share the work of one world.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

namespace pluvia {

// One thing after another that threads share: the numbers from 0 to `size`, of which a thread
// takes `length` at a time, or the caller all of them where there are no more. Every thread has
// its own stretch of them, and comes to that of a share when it is done with those before.
struct Share {
    static constexpr std::size_t ALL = ~std::size_t{0};

    std::size_t size, length;
    std::size_t least; // that it pays for a thread to take, however many threads there are
    const std::size_t *ends = nullptr; // by thread, where its stretch ends; null: equal stretches
    // How many of the shares before, from the first on, must be over, everybody's, before one
    // begins.
    std::size_t after = ALL;
};

// How long shares took that threads can share, in s: those of more than the least that pays for a
// thread. And how long they would take on other numbers of threads, were they done in equal parts
// by as many as have the least to do, and were there no waiting and no cache. A job's time is
// divided among its shares by how often each has the least.
struct SharedTime {
    static constexpr std::array<std::uint32_t, 3> THREADS{2, 8, 16};
    double now = 0;
    std::array<double, 3> on{};
};

// Runs one function on several threads, the caller's among them, and waits for
// all of them. What it computes must not depend on who computes which part.
class Workers {
  public:
    static constexpr std::size_t MOST_SHARES = 400; // of a job

    // `count`: threads in all, at least 1; fewer where the system gives no more.
    explicit Workers(int count);
    ~Workers();
    Workers(const Workers &) = delete;
    Workers &operator=(const Workers &) = delete;

    int count() const { return static_cast<int>(threads_.size()) + 1; }

    // Whether the caller does everything by itself from now on.
    void leave_alone(bool on) { alone_ = on; }

    // Calls `part(share, worker, begin, end)` for parts of each of `count` shares. `worker` is
    // smaller than `count()` and no two calls at a time have the same. A thread's stretch is the
    // same for the same size: what it wrote the last time is in its cache. The caller goes on
    // with the stretch of one that is late: where processors are shared, a worker may not run
    // for milliseconds.
    // What a part throws is thrown here, once all that began are over; of several, one.
    template <class Part> void share(const Share *shares, std::size_t count, const Part &part) {
        if (count > MOST_SHARES) {
            throw std::logic_error("a job with too many shares");
        }
        bool alone = true;
        bool small = true;
        for (std::size_t k = 0; k < count; ++k) {
            const bool is_small = shares[k].size <= shares[k].least;
            small = small && is_small;
            alone = alone &&
                    (shares[k].ends != nullptr ? is_small : shares[k].size <= shares[k].length);
        }
        const auto begun = small ? Clock::time_point{} : Clock::now();
        if (alone || alone_ || threads_.empty()) {
            for (std::size_t k = 0; k < count; ++k) {
                if (shares[k].size > 0) {
                    part(k, 0, std::size_t{0}, shares[k].size);
                }
            }
        } else {
            const auto call = [](const void *what, std::size_t k, int worker, std::size_t begin,
                                 std::size_t end) {
                (*static_cast<const Part *>(what))(k, worker, begin, end);
            };
            run({call, &part, shares, count});
        }
        if (!small) {
            account(shares, count, std::chrono::duration<double>(Clock::now() - begun).count());
        }
    }

    // Calls `what(i)` for all numbers below `size`, of which a thread takes `length` at a time; and
    // before, for one that is its own and comes `ahead` later, `ask`.
    template <class What, class Ask>
    void each(std::size_t size, std::size_t length, const What &what, std::size_t ahead,
              const Ask &ask) {
        const Share one{size, length, length};
        share(&one, 1, [&](std::size_t, int, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                if (i + ahead < end) {
                    ask(i + ahead);
                }
                what(i);
            }
        });
    }
    template <class What> void each(std::size_t size, std::size_t length, const What &what) {
        each(size, length, what, 0, [](std::size_t) {});
    }

    const SharedTime &shared() const { return shared_; }

  private:
    using Clock = std::chrono::steady_clock;

    struct Job {
        void (*call)(const void *part, std::size_t share, int worker, std::size_t begin,
                     std::size_t end) = nullptr;
        const void *part = nullptr;
        const Share *shares = nullptr;
        std::size_t count = 0;
    };
    // What a thread does first.
    struct alignas(64) Stretch {
        // The number of a job, and in the lower half twice how many parts are over, and one
        // more while the next is being done (not of the caller's, of which nobody else does
        // parts). Parts are done in this order, whoever does them.
        std::atomic<std::uint64_t> at{0};
        std::atomic<bool> late{false}; // others go on with it at once
        // How many parts come before a share's; at the end, all.
        std::array<std::atomic<std::uint32_t>, MOST_SHARES + 1> before{};
    };

    std::mutex mutex_;
    std::condition_variable begin_;
    Job job_;
    std::uint64_t number_ = 0; // of the job
    std::unique_ptr<Stretch[]> stretches_;
    // Of the job, for those who look without doing a part of it: it may be over at any time.
    std::array<std::atomic<std::uint32_t>, MOST_SHARES> after_{};
    std::atomic<std::uint32_t> shares_{0};
    std::atomic<int> asleep_{0};
    std::atomic<bool> closing_{false};
    std::atomic<bool> failed_{false};
    std::exception_ptr error_; // of the first part that failed
    bool alone_ = false;
    SharedTime shared_;
    std::vector<std::thread> threads_;

    void run(const Job &job);
    void account(const Share *shares, std::size_t count, double took);
    void publish(const Job &job);
    void lead();
    void work(int worker);
    void follow(int worker, std::uint64_t number);
    bool go_on(int worker, std::uint64_t number, std::size_t of, std::size_t &share);
    bool may_begin(std::uint64_t number, std::size_t of, std::size_t share) const;
    bool finished(std::uint64_t number, std::size_t of) const;
    void wait_for_job(int worker, std::uint64_t seen);
};

} // namespace pluvia
