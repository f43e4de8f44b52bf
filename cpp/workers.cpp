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

constexpr std::uint64_t LEFT = 0xffffffffU; // of a ticket: the lower half

std::uint64_t job_of(std::uint64_t ticket) { return ticket >> 32; }

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

template <class F> void wait_until(const F &is_true) {
    while (!at_once(LOOKS, is_true)) {
        std::this_thread::yield();
    }
}

// Numbers of a share from 0 up to the beginning of stretch number `i` of `count`.
std::size_t before(const Share &share, std::size_t i, std::size_t count) {
    if (share.size <= share.length) {
        return i == 0 ? 0 : share.size;
    }
    return share.size * i / count;
}

} // namespace

Workers::Workers(int count) : stretches_(new Stretch[static_cast<std::size_t>(count)]) {
    threads_.reserve(static_cast<std::size_t>(count));
    try {
        for (int worker = 1; worker < count; ++worker) {
            threads_.emplace_back([this, worker] { work(worker); });
        }
    } catch (...) {
        // The system gives no more threads: those that there are share the work.
    }
    parts_.resize(threads_.size() + 1);
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

// Takes and does a part of somebody's stretch of a share. False where none is left. While a part
// that was taken is not over, the job stays as it is; who takes none may look at nothing else of
// it.
bool Workers::take_part(int worker, std::uint64_t number, std::size_t of, std::size_t share) {
    Ticket &left = stretches_[of].tickets[share];
    std::uint64_t ticket = left.load();
    do {
        if (job_of(ticket) != number || (ticket & LEFT) == 0) {
            return false;
        }
    } while (!left.compare_exchange_weak(ticket, ticket - 1));
    const Share &whole = job_.shares[share];
    const auto count = static_cast<std::size_t>(this->count());
    // Parts are counted from the end of the stretch.
    const std::size_t begin = before(whole, of, count) + ((ticket & LEFT) - 1) * whole.length;
    const std::size_t end = std::min(before(whole, of + 1, count), begin + whole.length);
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
    --open_[share];
    return true;
}

// A worker sees a job by the first ticket of its own stretch, which is therefore written last;
// and its end by a ticket with another number.
void Workers::publish(const Job &job) {
    job_ = job;
    failed_ = false;
    number_ = (number_ + 1) & LEFT;
    const auto count = static_cast<std::size_t>(this->count());
    for (std::size_t k = job.count; k-- > 0;) {
        const Share &share = job.shares[k];
        std::uint64_t all = 0;
        std::size_t begin = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t end = before(share, i + 1, count);
            parts_[i] = (end - begin + share.length - 1) / share.length;
            all += parts_[i];
            begin = end;
        }
        open_[k].store(number_ << 32 | all, std::memory_order_release);
        for (std::size_t i = 0; i < count; ++i) {
            stretches_[i].tickets[k].store(number_ << 32 | parts_[i],
                                           k > 0 ? std::memory_order_release
                                                 : std::memory_order_seq_cst);
        }
    }
}

void Workers::run(const Job &job) {
    publish(job);
    if (asleep_ > 0) {
        const std::lock_guard<std::mutex> lock(mutex_);
        begin_.notify_all();
    }
    for (std::size_t k = 0; k < job.count; ++k) {
        while (take_part(0, number_, 0, k)) {
        }
        help(k);
        wait_until([&] { return (open_[k].load() & LEFT) == 0; });
    }
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

// Takes what those who are late have left of a share.
void Workers::help(std::size_t share) {
    for (std::size_t i = 1; i < static_cast<std::size_t>(count()); ++i) {
        Stretch &stretch = stretches_[i];
        const auto taken = [&] { return (stretch.tickets[share].load() & LEFT) == 0; };
        if (!stretch.late && at_once(PATIENCE, taken)) {
            continue;
        }
        while (take_part(0, number_, i, share)) {
            stretch.late = true;
        }
    }
}

void Workers::wait_for_job(int worker, std::uint64_t seen) {
    const Ticket &own = stretches_[static_cast<std::size_t>(worker)].tickets[0];
    const auto called = [&] { return closing_ || job_of(own.load()) != seen; };
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

// Does a worker's parts of a job. It may be over at any time, taken by the caller.
void Workers::follow(int worker, std::uint64_t number) {
    const auto own = static_cast<std::size_t>(worker);
    Stretch &stretch = stretches_[own];
    for (std::size_t k = 0; k < MOST_SHARES; ++k) {
        if (job_of(stretch.tickets[k].load()) != number) {
            return;
        }
        if (k > 0) {
            wait_until([&] {
                const std::uint64_t open = open_[k - 1].load();
                return (open & LEFT) == 0 || job_of(open) != number;
            });
        }
        if (stretch.late) {
            stretch.late = false;
        }
        while (take_part(worker, number, own, k)) {
        }
    }
}

void Workers::work(int worker) {
    const Ticket &first = stretches_[static_cast<std::size_t>(worker)].tickets[0];
    std::uint64_t seen = 0;
    for (;;) {
        wait_for_job(worker, seen);
        if (closing_) {
            return;
        }
        seen = job_of(first.load());
        follow(worker, seen);
    }
}

} // namespace pluvia
