#include "workers.h"

#include <algorithm>
#include <atomic>

namespace pluvia {

struct Workers::Job {
    std::size_t size, length;
    const std::function<void(int, std::size_t, std::size_t)> &part;
    std::atomic<std::size_t> next{0};

    void run(int worker) {
        for (;;) {
            const std::size_t begin = next.fetch_add(length);
            if (begin >= size) {
                return;
            }
            part(worker, begin, std::min(size, begin + length));
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
    Job job{size, length, part};
    if (threads_.empty() || size <= length) {
        job.run(0);
        return;
    }
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        job_ = &job;
        busy_ = static_cast<int>(threads_.size());
        ++round_;
    }
    begin_.notify_all();
    job.run(0);
    std::unique_lock<std::mutex> lock(mutex_);
    end_.wait(lock, [this] { return busy_ == 0; });
    job_ = nullptr;
}

void Workers::work(int worker) {
    unsigned long seen = 0;
    for (;;) {
        Job *job = nullptr;
        {
            std::unique_lock<std::mutex> lock(mutex_);
            begin_.wait(lock, [this, seen] { return closing_ || round_ != seen; });
            if (closing_) {
                return;
            }
            seen = round_;
            job = job_;
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
