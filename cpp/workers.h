// A few threads that share the work of one world.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <functional>
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
    // smaller than `count()` and no two calls at a time have the same. A worker
    // takes its own stretch first: what it wrote the last time is in its cache.
    // What a part throws is thrown here, once all of them are over; of several, one.
    void share(std::size_t size, std::size_t length,
               const std::function<void(int worker, std::size_t begin, std::size_t end)> &part);

  private:
    struct Job;

    std::mutex mutex_;
    std::condition_variable begin_, end_;
    Job *job_ = nullptr;                  // that workers may take part in
    std::atomic<unsigned long> round_{0}; // of jobs
    std::atomic<int> busy_{0};            // workers that take part in the job
    std::atomic<bool> closing_{false};
    std::vector<std::thread> threads_;

    void work(int worker);
};

} // namespace pluvia
