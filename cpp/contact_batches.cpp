#include "contact_batches.h"

#include <algorithm>

namespace pluvia {

// First batch from `from` on that has room; full ones are skipped, and what
// was skipped is remembered (path halving).
int Schedule::with_room(int from) {
    while (next_[from] != from) {
        next_[from] = next_[next_[from]];
        from = next_[from];
    }
    return from;
}

void Schedule::assign(const ContactRows &rows, const std::vector<SolverBody> &bodies, int width) {
    const std::size_t count = rows.size();
    batches_ = 0;
    first_ = 0;
    batch_.resize(count);
    lane_.resize(count);
    after_.assign(bodies.size(), 0);
    used_.assign(count + 1, 0);
    next_.resize(count + 2);
    for (std::size_t i = 0; i < next_.size(); ++i) {
        next_[i] = static_cast<int>(i);
    }
    for (const bool near : {true, false}) {
        for (std::size_t i = 0; i < count; ++i) {
            if (rows[i].near == near) {
                place(i, rows[i], bodies, width);
            }
        }
        if (near) {
            near_batches_ = batches_;
            first_ = batches_;
        }
    }
}

void Schedule::place(std::size_t row, const ContactRow &contact,
                     const std::vector<SolverBody> &bodies, int width) {
    // What does not move is not changed by its contacts, and may occur
    // several times.
    const bool moves_a = bodies[contact.a].inverse_mass > 0;
    const bool moves_b = bodies[contact.b].inverse_mass > 0;
    const int from =
        std::max({first_, moves_a ? after_[contact.a] : 0, moves_b ? after_[contact.b] : 0});
    const int batch = with_room(from);
    batch_[row] = batch;
    lane_[row] = used_[batch]++;
    if (used_[batch] == width) {
        next_[batch] = batch + 1;
    }
    if (moves_a) {
        after_[contact.a] = batch + 1;
    }
    if (moves_b) {
        after_[contact.b] = batch + 1;
    }
    batches_ = std::max(batches_, batch + 1);
}

} // namespace pluvia
