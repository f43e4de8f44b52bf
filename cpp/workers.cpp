#include "workers.h"

#include <algorithm>
#include <chrono>
#include <exception>

namespace pluvia {

namespace {

// A step asks for several jobs within milliseconds. Who sleeps in between wakes
// too late to help, and on the processor of who woke it: so workers stay
// awake for a few of them, but leave the processor to whoever else wants it.
constexpr std::chrono::milliseconds AWAKE{4};
constexpr int PAUSES = 64;

void pause() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
}

// Whether it came true within that time.
template <class F> bool soon(const F &is_true) {
    for (int i = 0; i < PAUSES; ++i) {
        if (is_true()) {
            return true;
        }
        pause();
    }
    const auto until = std::chrono::steady_clock::now() + AWAKE;
    do {
        std::this_thread::yield();
        if (is_true()) {
            return true;
        }
    } while (std::chrono::steady_clock::now() < until);
    return false;
}

} // namespace

struct Workers::Job {
    std::size_t size, length;
    const std::function<void(int, std::size_t, std::size_t)> &part;
    std::vector<std::atomic<std::size_t>> next; // by worker: where its share goes on
    std::atomic<bool> failed{false};
    std::exception_ptr error; // of the first part that failed

    Job(int count, std::size_t size, std::size_t length,
        const std::function<void(int, std::size_t, std::size_t)> &part)
        : size(size), length(length), part(part), next(static_cast<std::size_t>(count)) {
        for (std::size_t share = 0; share < next.size(); ++share) {
            next[share] = begin_of(share);
        }
    }

    std::size_t begin_of(std::size_t share) const { return size * share / next.size(); }

    // An exception may leave neither a thread nor, while others are at work, the
    // job that they share.
    void run(int worker) {
        try {
            run_parts(worker);
        } catch (...) {
            if (!failed.exchange(true)) {
                error = std::current_exception();
            }
        }
    }

    // First the own share, then what others have left of theirs.
    void run_parts(int worker) {
        for (std::size_t i = 0; i < next.size(); ++i) {
            const std::size_t share = (static_cast<std::size_t>(worker) + i) % next.size();
            const std::size_t end = begin_of(share + 1);
            for (;;) {
                const std::size_t begin = next[share].fetch_add(length);
                if (begin >= end) {
                    break;
                }
                part(worker, begin, std::min(end, begin + length));
            }
        }
    }
};

Workers::Workers(int count) {
    for (int worker = 1; worker < count; ++worker) {
        threads_.emplace_back([this, worker] { work(worker); });
    }
}

Workers::~Workers() {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        closing_ = true;
    }
    begin_.notify_all();
    for (std::thread &thread : threads_) {
        thread.join();
    }
}

void Workers::share(std::size_t size, std::size_t length,
                    const std::function<void(int, std::size_t, std::size_t)> &part) {
    if (size == 0) {
        return;
    }
    if (threads_.empty() || size <= length) {
        part(0, 0, size);
        return;
    }
    Job job(count(), size, length, part);
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        job_ = &job;
        ++round_;
    }
    begin_.notify_all();
    job.run(0);
    // Nothing is left to take. Who has not come yet need not: where processors are
    // shared, a worker may not run for milliseconds.
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        job_ = nullptr;
    }
    const auto ended = [this] { return busy_ == 0; };
    if (!soon(ended)) {
        std::unique_lock<std::mutex> lock(mutex_);
        end_.wait(lock, ended);
    }
    if (job.failed) {
        std::rethrow_exception(job.error);
    }
}

void Workers::work(int worker) {
    unsigned long seen = 0;
    for (;;) {
        const auto called = [this, &seen] { return closing_ || round_ != seen; };
        if (!soon(called)) {
            std::unique_lock<std::mutex> lock(mutex_);
            begin_.wait(lock, called);
        }
        if (closing_) {
            return;
        }
        Job *job = nullptr;
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            seen = round_;
            job = job_;
            busy_ += job ? 1 : 0;
        }
        if (!job) {
            continue; // it is over
        }
        job->run(worker);
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            --busy_;
        }
        end_.notify_one();
    }
}

} // namespace pluvia
