#include "workers.h"

#include <algorithm>
#include <chrono>

namespace pluvia {

namespace {

// A step asks for hundreds of jobs within milliseconds. Who sleeps in between wakes
// too late to help, and on the processor of who woke it: so workers stay
// awake for a few milliseconds, but leave the processor to whoever else wants it.
constexpr std::chrono::milliseconds AWAKE{4};

// Looks at a number that another thread is about to write, before the processor is left.
constexpr int LOOKS = 256;

// As many before the stretch of a worker that does not come is taken from it: some
// microseconds, longer than one that is awake needs.
constexpr int PATIENCE = 128;

constexpr std::uint64_t LEFT = 0xffffffffU; // of a ticket: the parts that nobody has taken

void pause() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
}

// Whether it came true within some looks.
template <class F> bool at_once(int looks, const F &is_true) {
    for (int i = 0; i < looks; ++i) {
        if (is_true()) {
            return true;
        }
        pause();
    }
    return false;
}

} // namespace

Workers::Workers(int count) : stretches_(static_cast<std::size_t>(count)) {
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

// Takes and does a part of a stretch. False where none is left. While a part that was taken
// is not over, the job stays as it is; who takes none may look at nothing else of it.
bool Workers::take_part(int worker, Stretch &stretch) {
    std::uint64_t ticket = stretch.ticket.load();
    do {
        if ((ticket & LEFT) == 0) {
            return false;
        }
    } while (!stretch.ticket.compare_exchange_weak(ticket, ticket - 1));
    // Parts are counted from the end of the stretch.
    const std::size_t before = ((ticket & LEFT) - 1) * job_.length;
    const std::size_t begin = stretch.begin + before;
    const std::size_t end = std::min(stretch.end, begin + job_.length);
    // An exception may leave neither a thread nor, while others are at work, the
    // job that they share.
    try {
        job_.call(job_.part, worker, begin, end);
    } catch (...) {
        if (!failed_.exchange(true)) {
            error_ = std::current_exception();
        }
    }
    --open_;
    return true;
}

void Workers::run(const Job &job) {
    job_ = job;
    failed_ = false;
    ++number_;
    const std::size_t count = stretches_.size();
    std::size_t parts = 0;
    for (std::size_t i = 0; i < count; ++i) {
        Stretch &stretch = stretches_[i];
        stretch.begin = job.size * i / count;
        stretch.end = job.size * (i + 1) / count;
        parts += (stretch.end - stretch.begin + job.length - 1) / job.length;
    }
    open_ = parts;
    for (Stretch &stretch : stretches_) {
        const std::uint64_t own = (stretch.end - stretch.begin + job.length - 1) / job.length;
        stretch.ticket = number_ << 32 | own;
    }
    if (asleep_ > 0) {
        const std::lock_guard<std::mutex> lock(mutex_);
        begin_.notify_all();
    }
    while (take_part(0, stretches_[0])) {
    }
    for (Stretch &stretch : stretches_) {
        const auto taken = [&stretch] { return (stretch.ticket.load() & LEFT) == 0; };
        if (!stretch.late && at_once(PATIENCE, taken)) {
            continue;
        }
        while (take_part(0, stretch)) {
            stretch.late = true;
        }
    }
    const auto over = [this] { return open_ == 0; };
    while (!at_once(LOOKS, over)) {
        std::this_thread::yield();
    }
    if (failed_) {
        std::rethrow_exception(error_);
    }
}

void Workers::wait_for_job(int worker, std::uint64_t seen) {
    const Stretch &own = stretches_[static_cast<std::size_t>(worker)];
    const auto called = [&] { return closing_ || own.ticket.load() >> 32 != seen; };
    const auto until = std::chrono::steady_clock::now() + AWAKE;
    do {
        if (at_once(LOOKS, called)) {
            return;
        }
        std::this_thread::yield();
    } while (std::chrono::steady_clock::now() < until);
    std::unique_lock<std::mutex> lock(mutex_);
    ++asleep_;
    begin_.wait(lock, called);
    --asleep_;
}

void Workers::work(int worker) {
    Stretch &own = stretches_[static_cast<std::size_t>(worker)];
    std::uint64_t seen = 0;
    for (;;) {
        wait_for_job(worker, seen);
        if (closing_) {
            return;
        }
        seen = own.ticket.load() >> 32;
        own.late = false;
        while (take_part(worker, own)) {
        }
    }
}

} // namespace pluvia
