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

// As Bullet's near callback, for pairs of hulls only: leaves out what cannot touch.
void HullDispatcher::take(btBroadphasePair &pair) {
    const auto *a = static_cast<const btCollisionObject *>(pair.m_pProxy0->m_clientObject);
    const auto *b = static_cast<const btCollisionObject *>(pair.m_pProxy1->m_clientObject);
    auto *algorithm = static_cast<HullAlgorithm *>(pair.m_algorithm);
    if (algorithm == nullptr || !algorithm->holds_contacts()) {
        const btScalar approach = approach_in_step(*a, *b, collision_->step);
        if (!within_reach(pair, static_cast<btScalar>(collision_->settings.reach) + approach)) {
            return;
        }
    }
    if (!needsCollision(a, b)) {
        return;
    }
    if (algorithm == nullptr) {
        const btCollisionObjectWrapper on_a(nullptr, a->getCollisionShape(), a,
                                            a->getWorldTransform(), -1, -1);
        const btCollisionObjectWrapper on_b(nullptr, b->getCollisionShape(), b,
                                            b->getWorldTransform(), -1, -1);
        algorithm = static_cast<HullAlgorithm *>(
            findAlgorithm(&on_a, &on_b, nullptr, BT_CONTACT_POINT_ALGORITHMS));
        pair.m_algorithm = algorithm;
    }
    work_.push_back({algorithm, a, b});
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
