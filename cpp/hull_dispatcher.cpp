#include "hull_dispatcher.h"

#include "pairs.h"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>

#include <algorithm>

namespace pluvia {

HullDispatcher::HullDispatcher(btCollisionConfiguration *configuration, HullCollision *collision,
                               int threads)
    : btCollisionDispatcher(configuration), collision_(collision) {
    if (collision_ == nullptr) {
        setNearCallback(&near_callback);
        return;
    }
    create_ = std::make_unique<HullCreateFunc>(*collision_);
    registerCollisionCreateFunc(CONVEX_HULL_SHAPE_PROXYTYPE, CONVEX_HULL_SHAPE_PROXYTYPE,
                                create_.get());
    workers_ = std::make_unique<Workers>(threads);
    scratch_.resize(static_cast<std::size_t>(threads));
    by_thread_.resize(static_cast<std::size_t>(threads));
}

// As Bullet's near callback, for pairs of hulls only: leaves out what cannot
// touch. Every body takes part in every step, so nothing else is asked.
void HullDispatcher::take(btBroadphasePair &pair) {
    const btBroadphaseProxy &a = *pair.m_pProxy0;
    const btBroadphaseProxy &b = *pair.m_pProxy1;
    const HullBodies &bodies = collision_->bodies;
    auto *algorithm = static_cast<HullAlgorithm *>(pair.m_algorithm);
    if (!bodies.range(a).meets(bodies.range(b)) &&
        (algorithm == nullptr || !algorithm->holds_contacts())) {
        return;
    }
    const HullBody &body_a = bodies.body(a);
    const HullBody &body_b = bodies.body(b);
    if (algorithm == nullptr) {
        const btCollisionObject &object_a = *body_a.object;
        const btCollisionObject &object_b = *body_b.object;
        const btCollisionObjectWrapper on_a(nullptr, object_a.getCollisionShape(), &object_a,
                                            object_a.getWorldTransform(), -1, -1);
        const btCollisionObjectWrapper on_b(nullptr, object_b.getCollisionShape(), &object_b,
                                            object_b.getWorldTransform(), -1, -1);
        algorithm = static_cast<HullAlgorithm *>(
            findAlgorithm(&on_a, &on_b, nullptr, BT_CONTACT_POINT_ALGORITHMS));
        pair.m_algorithm = algorithm;
    }
    work_.push_back({algorithm, &body_a, &body_b});
}

void HullDispatcher::dispatchAllCollisionPairs(btOverlappingPairCache *pairs,
                                               const btDispatcherInfo &info,
                                               btDispatcher *dispatcher) {
    if (collision_ == nullptr) {
        btCollisionDispatcher::dispatchAllCollisionPairs(pairs, info, dispatcher);
        return;
    }
    work_.clear();
    btBroadphasePair *const first = pairs->getOverlappingPairArrayPtr();
    for (int i = 0; i < pairs->getNumOverlappingPairs(); ++i) {
        take(first[i]);
    }
    workers_->share(work_.size(), [this](int worker, std::size_t begin, std::size_t end) {
        const auto w = static_cast<std::size_t>(worker);
        PairContact contact;
        for (std::size_t i = begin; i < end; ++i) {
            const Work &work = work_[i];
            if (i + 8 < end) {
                work_[i + 8].algorithm->prefetch();
            }
            if (i + 4 < end) {
                const Work &soon = work_[i + 4];
                soon.algorithm->prefetch_points();
                prefetch(soon.a->hull->vx, soon.a->hull->bytes);
                prefetch(soon.b->hull->vx, soon.b->hull->bytes);
            }
            if (work.algorithm->find(*work.a, *work.b, scratch_[w], contact)) {
                by_thread_[w].push_back({i, contact});
            }
        }
    });
    changes_.clear();
    for (auto &changes : by_thread_) {
        changes_.insert(changes_.end(), changes.begin(), changes.end());
        changes.clear();
    }
    std::sort(changes_.begin(), changes_.end(),
              [](const Change &a, const Change &b) { return a.work < b.work; });
    for (const Change &change : changes_) {
        const Work &work = work_[change.work];
        work.algorithm->change(*work.a, *work.b, change.contact);
    }
}

} // namespace pluvia
