// A few threads that share the work of one world.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace pluvia {

// Runs one function on several threads, the caller's among them, and waits for
// all of them. What it computes must not depend on who computes which part.
class Workers {
  public:
    // `count`: threads in all, at least 1.
    explicit Workers(int count);
    ~Workers();
    Workers(const Workers &) = delete;
    Workers &operator=(const Workers &) = delete;

    int count() const { return static_cast<int>(threads_.size()) + 1; }

    // Calls `part(worker, begin, end)` for parts of 0 to `size`, each of `length`
    // or less, or one by the caller for all where there are no others; `worker` is
    // smaller than `count()` and no two calls at a time have the same. Every worker
    // has its own stretch, the same for the same size: what it wrote the last time is in
    // its cache. The caller takes what is left of the stretch of one that is late: where
    // processors are shared, a worker may not run for milliseconds.
    // What a part throws is thrown here, once all of them are over; of several, one.
    template <class Part> void share(std::size_t size, std::size_t length, const Part &part) {
        if (size == 0) {
            return;
        }
        if (threads_.empty() || size <= length) {
            part(0, std::size_t{0}, size);
            return;
        }
        const auto call = [](const void *what, int worker, std::size_t begin, std::size_t end) {
            (*static_cast<const Part *>(what))(worker, begin, end);
        };
        run({call, &part, size, length});
    }

  private:
    struct Job {
        void (*call)(const void *part, int worker, std::size_t begin, std::size_t end) = nullptr;
        const void *part = nullptr;
        std::size_t size = 0, length = 1;
    };
    // A worker's stretch of the job.
    struct alignas(64) Stretch {
        // The number of the job, and in the lower half how many of its parts nobody has taken.
        std::atomic<std::uint64_t> ticket{0};
        std::atomic<bool> late{false}; // its parts are taken at once
        std::size_t begin = 0, end = 0;
    };

    std::mutex mutex_;
    std::condition_variable begin_;
    Job job_;
    std::uint64_t number_ = 0; // of the job
    std::vector<Stretch> stretches_;
    alignas(64) std::atomic<std::size_t> open_{0}; // parts of the job that are not over
    std::atomic<int> asleep_{0};
    std::atomic<bool> closing_{false};
    std::atomic<bool> failed_{false};
    std::exception_ptr error_; // of the first part that failed
    std::vector<std::thread> threads_;

    void run(const Job &job);
    void work(int worker);
    bool take_part(int worker, Stretch &stretch);
    void wait_for_job(int worker, std::uint64_t seen);
};

} // namespace pluvia
