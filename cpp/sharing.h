// Whether the threads of a world share a step.
#pragma once

#include <array>

namespace pluvia {

// Threads can take longer together than one alone (docs/contacts.md, "What it costs"). So
// where a world may leave them, both are tried now and then, and the faster one goes on:
// which it is changes no bit.
class Sharing {
  public:
    explicit Sharing(bool may_leave) : may_leave_(may_leave) {}

    // Whether the next step is one thread's.
    bool alone() const {
        // Shared, alone, alone, shared: what grows or shrinks meanwhile counts alike.
        const int block = step_ / BLOCK;
        return may_leave_ && (step_ < TRIAL ? block == 1 || block == 2 : alone_);
    }

    // How long it took, in s.
    void took(double seconds) {
        // The first of a block finds everything in another cache.
        if (step_ < TRIAL && step_ % BLOCK > 0) {
            spent_[alone() ? 1 : 0] += seconds;
        }
        if (++step_ == TRIAL) {
            alone_ = spent_[1] < spent_[0];
            spent_ = {0, 0};
        }
        step_ %= PERIOD;
    }

  private:
    static constexpr int BLOCK = 5, TRIAL = 4 * BLOCK, PERIOD = 400; // steps
    bool may_leave_;
    int step_ = PERIOD - 24; // a new world has much to do that it does once
    bool alone_ = false;
    std::array<double, 2> spent_{}; // shared, alone
};

} // namespace pluvia
