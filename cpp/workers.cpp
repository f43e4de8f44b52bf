// Runs work in parts on several threads that wait for each other only where the order matters.
#include "workers.h"

#include <algorithm>
#include <cmath>
#include <utility>

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

constexpr std::uint64_t PARTS = 0xffffffffU; // of where a stretch is at: the lower half
constexpr std::uint64_t BUSY = 1;

std::uint64_t job_of(std::uint64_t at) { return at >> 32; }
std::uint64_t over(std::uint64_t at) { return (at & PARTS) >> 1; }

void pause() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
}

// Between one look in vain and the next.
void look_again(int &looks) {
    if (++looks % LOOKS == 0) {
        std::this_thread::yield();
    } else {
        pause();
    }
}

// Where stretch number `i` of `count` begins; that of number `count` is the end.
std::size_t begin_of(const Share &share, std::size_t i, std::size_t count) {
    if (i == 0) {
        return 0;
    }
    if (share.ends != nullptr) {
        return share.ends[i - 1];
    }
    return share.size <= share.length ? share.size : share.size * i / count;
}

} // namespace

Workers::Workers(int count) : stretches_(new Stretch[count]) {
    threads_.reserve(static_cast<std::size_t>(count));
    try {
        for (int worker = 1; worker < count; ++worker) {
            threads_.emplace_back([this, worker] { work(worker); });
        }
    } catch (...) {
        // The system gives no more threads: those that there are share the work.
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

// Whether all that a share of a stretch waits for is over.
bool Workers::may_begin(std::uint64_t number, std::size_t of, std::size_t share) const {
    const auto count = static_cast<std::size_t>(this->count());
    const std::size_t after = after_[share].load(std::memory_order_acquire);
    for (std::size_t i = 0; i < count; ++i) {
        const Stretch &other = stretches_[i];
        const std::uint32_t parts = other.before[after].load(std::memory_order_acquire);
        if (i == of || parts == 0) {
            continue;
        }
        const std::uint64_t at = other.at.load(std::memory_order_acquire);
        if (job_of(at) != number || over(at) < parts) {
            return false;
        }
    }
    return true;
}

bool Workers::finished(std::uint64_t number, std::size_t of) const {
    const Stretch &stretch = stretches_[of];
    const std::uint64_t at = stretch.at.load(std::memory_order_acquire);
    const std::size_t shares = shares_.load(std::memory_order_acquire);
    return job_of(at) != number ||
           ((at & BUSY) == 0 && over(at) == stretch.before[shares].load(std::memory_order_acquire));
}

// Does the next part of a stretch, whose share is `share` or a later one. False where there is
// none, where somebody is at it, or where it must wait. While a part is being done the job stays
// as it is; who does none may look at nothing else of it.
bool Workers::go_on(int worker, std::uint64_t number, std::size_t of, std::size_t &share) {
    Stretch &stretch = stretches_[of];
    std::uint64_t at = stretch.at.load(std::memory_order_acquire);
    const std::size_t shares = shares_.load(std::memory_order_acquire);
    const auto before = [&](std::size_t k) {
        return stretch.before[k].load(std::memory_order_acquire);
    };
    if (job_of(at) != number || (at & BUSY) != 0) {
        return false;
    }
    while (share < shares && before(share + 1) <= over(at)) {
        ++share;
    }
    if (share >= shares || !may_begin(number, of, share)) {
        return false;
    }
    // Nobody else does parts of the caller's.
    if (of != 0 && !stretch.at.compare_exchange_strong(at, at | BUSY, std::memory_order_acq_rel)) {
        return false;
    }
    const Share &whole = job_.shares[share];
    const auto count = static_cast<std::size_t>(this->count());
    const std::size_t begin =
        begin_of(whole, of, count) + (over(at) - before(share)) * whole.length;
    const std::size_t end = std::min(begin_of(whole, of + 1, count), begin + whole.length);
    // An exception may leave neither a thread nor, while others are at work, the
    // job that they share.
    try {
        if (!failed_) {
            job_.call(job_.part, share, worker, begin, end);
        }
    } catch (...) {
        if (!failed_.exchange(true)) {
            error_ = std::current_exception();
        }
    }
    stretch.at.store(at + 2 * BUSY, std::memory_order_release);
    return true;
}

// A worker sees a job by its own stretch, which is therefore written last. Before anything else
// is written, nobody can begin a part any more.
void Workers::publish(const Job &job) {
    number_ = (number_ + 1) & PARTS;
    const auto count = static_cast<std::size_t>(this->count());
    for (std::size_t i = 0; i < count; ++i) {
        stretches_[i].at.store(number_ << 32 | BUSY);
    }
    job_ = job;
    failed_ = false;
    shares_.store(static_cast<std::uint32_t>(job.count), std::memory_order_release);
    for (std::size_t k = 0; k < job.count; ++k) {
        after_[k].store(static_cast<std::uint32_t>(std::min(job.shares[k].after, k)),
                        std::memory_order_release);
    }
    for (std::size_t i = 0; i < count; ++i) {
        std::uint32_t parts = 0;
        for (std::size_t k = 0; k < job.count; ++k) {
            stretches_[i].before[k].store(parts, std::memory_order_release);
            const Share &share = job.shares[k];
            const std::size_t size = begin_of(share, i + 1, count) - begin_of(share, i, count);
            parts += static_cast<std::uint32_t>((size + share.length - 1) / share.length);
        }
        stretches_[i].before[job.count].store(parts, std::memory_order_release);
    }
    for (std::size_t i = 0; i < count; ++i) {
        stretches_[i].at.store(number_ << 32);
    }
}

void Workers::run(const Job &job) {
    publish(job);
    if (asleep_ > 0) {
        const std::lock_guard<std::mutex> lock(mutex_);
        begin_.notify_all();
    }
    lead();
    if (failed_) {
        std::rethrow_exception(std::exchange(error_, nullptr));
    }
}

void Workers::account(const Share *shares, std::size_t count, double took) {
    double all = 0, shared = 0;
    std::array<double, SharedTime::THREADS.size()> left{};
    for (std::size_t k = 0; k < count; ++k) {
        const double parts =
            static_cast<double>(shares[k].size) / static_cast<double>(shares[k].least);
        all += parts;
        if (shares[k].size <= shares[k].least) {
            continue;
        }
        shared += parts;
        for (std::size_t t = 0; t < left.size(); ++t) {
            const double threads = std::min<double>(SharedTime::THREADS[t], std::ceil(parts));
            left[t] += parts / threads;
        }
    }
    shared_.now += took * shared / all;
    for (std::size_t t = 0; t < left.size(); ++t) {
        shared_.on[t] += took * left[t] / all;
    }
}

// Does the caller's stretch, and goes on with those of others who do not come.
void Workers::lead() {
    std::size_t own = 0;
    for (int looks = 0;;) {
        if (go_on(0, number_, 0, own)) {
            looks = 0;
            continue;
        }
        bool all = finished(number_, 0);
        for (std::size_t i = 1; i < static_cast<std::size_t>(count()); ++i) {
            if (finished(number_, i)) {
                continue;
            }
            all = false;
            Stretch &stretch = stretches_[i];
            std::size_t share = 0;
            if ((stretch.late || looks >= PATIENCE) && go_on(0, number_, i, share)) {
                stretch.late = true;
            }
        }
        if (all) {
            return;
        }
        look_again(looks);
    }
}

void Workers::wait_for_job(int worker, std::uint64_t seen) {
    const Stretch &own = stretches_[worker];
    const auto called = [&] { return closing_ || job_of(own.at.load()) != seen; };
    const auto until = Clock::now() + AWAKE;
    int looks = 0;
    do {
        if (called()) {
            return;
        }
        look_again(looks);
    } while (looks % LOOKS != 0 || Clock::now() < until);
    std::unique_lock<std::mutex> lock(mutex_);
    ++asleep_;
    begin_.wait(lock, called);
    --asleep_;
}

// Does a worker's stretch of a job. It may be over at any time, done by the caller.
void Workers::follow(int worker, std::uint64_t number) {
    const auto own = static_cast<std::size_t>(worker);
    Stretch &stretch = stretches_[own];
    std::size_t share = 0;
    for (int looks = 0; !finished(number, own);) {
        if (go_on(worker, number, own, share)) {
            looks = 0;
            if (stretch.late) {
                stretch.late = false;
            }
        } else {
            look_again(looks);
        }
    }
}

void Workers::work(int worker) {
    const Stretch &own = stretches_[worker];
    std::uint64_t seen = 0;
    for (;;) {
        wait_for_job(worker, seen);
        if (closing_) {
            return;
        }
        seen = job_of(own.at.load());
        follow(worker, seen);
    }
}

} // namespace pluvia
