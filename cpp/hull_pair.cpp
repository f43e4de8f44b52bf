// Finds the contact of two convex polyhedra by the separating axis test, starting from what the
// pair remembers of the last step.
#include "hull_pair.h"

#include "hull_frames.h"

#include <algorithm>

namespace pluvia {

namespace {

// A gap that every feature comes up to.
constexpr double ANY = -1e30;

// Everything about the pair at hand.
class Pair : PairFrames {
  public:
    explicit Pair(const PairCase &pair) : PairFrames(pair) {}

    void run() {
        const bool fresh = memory.feature == Feature::None;
        if (fresh && memory.has_axis && still_apart()) {
            return;
        }
        if (!fresh && (memory.recalled ? keep_recalled() : hold())) {
            return;
        }
        // No axis can have a wider gap now than this.
        const float bound = fresh ? 0 : memory.widest + moved(memory.pose);
        if (!fresh && keep(bound)) {
            return;
        }
        relative_ = b_to_a_.rounded();
        scratch.axis.fit(a, b);
        kernels.faces(a, b, relative_, scratch.axis, faces_);
        const bool is_a = faces_.gap_a >= faces_.gap_b;
        const float widest = is_a ? faces_.gap_a : faces_.gap_b;
        if (widest > margin()) {
            part(is_a ? a.normal(faces_.face_a) : -scratch.axis.normal_b(faces_.face_b), widest);
            return;
        }
        const float depth = fresh ? -1 : std::max(bound, -widest);
        find_edges(widest, depth);
        if (edges_.edge_a >= 0 && edges_.gap > margin()) {
            part(three(edges_.axis), edges_.gap);
            return;
        }
        memory.widest = edges_.edge_a >= 0 ? edges_.gap : widest;
        memory.pose = now_;
        if (edges_.gap <= widest + preference()) {
            edges_.edge_a = -1;
        }
        if (fresh || !keep(edges_.edge_a >= 0 ? edges_.gap : widest)) {
            choose(is_a, widest, depth);
        }
    }

  private:
    Relative relative_;
    FaceGaps faces_;
    EdgeGap edges_;
    int incident_ = -1;  // the face found last to meet a reference face
    double deepest_ = 0; // of the points made last

    float margin() const { return static_cast<float>(settings.speculative_margin); }
    float preference() const { return static_cast<float>(settings.face_preference); }
    // By how much edges may miss each other and still push midway: to no more than the preference
    // beyond either surface.
    double most_off() const { return 2 * settings.face_preference; }

    // Whether the axis that parted the pair does so still.
    bool still_apart() {
        memory.widest = static_cast<float>(gap_along(three(memory.axis)));
        return memory.widest > margin();
    }

    // What touched when another pair found it touches still; a search might
    // find what is better by no more than it may have been then.
    bool keep_recalled() {
        memory.pose = now_;
        const bool kept = keep(ANY);
        memory.recalled = false;
        return kept;
    }

    // The points of the last step, at the gaps they have now; of edges, where
    // they come closest now. False where there are none.
    bool hold() {
        if (memory.feature == Feature::Edges) {
            return moved(memory.pose) <= settings.hold && keep_edges(ANY);
        }
        if (!holds_face()) {
            return false;
        }
        const bool is_a = memory.feature == Feature::FaceOfA;
        const Vec normal = three(memory.plane_normal);
        ClipPoint points[MOST_POINTS];
        for (int i = 0; i < memory.last.count; ++i) {
            const KeptPoint &before = memory.last.points[i];
            const Vec x = from_incident(is_a).apply(three(is_a ? before.on_b : before.on_a));
            const double gap = normal.dot(x) - static_cast<double>(memory.plane_offset);
            points[i] = {x, gap, before.id};
        }
        put(is_a, normal, points, memory.last.count);
        out.held = true;
        return true;
    }

    void find_edges(float best, float depth) {
        kernels.edges(a, b, relative_, faces_, best, margin(), depth, scratch.axis, edges_);
    }

    // Apart by more than the speculative margin along an axis.
    void part(const Vec &axis, float gap) {
        memory.widest = gap;
        memory.feature = Feature::None;
        memory.has_axis = true;
        store(axis, memory.axis);
    }

    // Goes on with the feature of the last step if it is nearly the best and
    // its points bear it out.
    bool keep(double best) {
        const double least = best - settings.hysteresis;
        if (memory.feature == Feature::Edges) {
            return keep_edges(least);
        }
        const bool is_a = memory.feature == Feature::FaceOfA;
        const double gap = meet_face(is_a, memory.first, memory.second);
        if (gap < least) {
            return false;
        }
        take_face(is_a, memory.first);
        // What is recalled may have been held for longer than a search would keep it.
        return out.count > 0 && (memory.recalled || deepest_ <= gap + settings.hysteresis);
    }

    bool keep_edges(double least) {
        const double slack = settings.hysteresis;
        const EdgeContact edge = edge_contact(a, memory.first, b, memory.second, b_to_a_);
        if (!edge.defined || edge.off > most_off()) {
            return false;
        }
        const double gap = gap_along(edge.axis);
        if (gap < least || edge.gap > gap + slack) {
            return false;
        }
        take(edge);
        return true;
    }

    // The best feature, whatever was before.
    void choose(bool is_a, float widest, float depth) {
        if (edges_.edge_a >= 0 && take_edges()) {
            return;
        }
        const int face = is_a ? faces_.face_a : faces_.face_b;
        const PairFace passed = passing_face(*this, {is_a, face});
        meet_face(passed.is_a, passed.face, -1);
        take_face(passed.is_a, passed.face);
        if (passed != PairFace{is_a, face}) {
            forget_without_points();
            return;
        }
        if (out.count > 0 && deepest_ <= static_cast<double>(widest) + settings.face_preference) {
            return;
        }
        // The face's plane is as good as any axis, but no face of the other
        // body lies against it: edges that are hardly worse, then.
        find_edges(widest - preference(), depth);
        if (edges_.edge_a >= 0 && edges_.gap > margin()) {
            out.count = 0;
            part(three(edges_.axis), edges_.gap);
            return;
        }
        if (edges_.edge_a >= 0 && take_edges()) {
            return;
        }
        if (out.count > 0) {
            return;
        }
        if (edges_.edge_a >= 0 && take_edges(true)) {
            return;
        }
        if (memory.widest < 0) {
            take_lowest(is_a, face);
        }
        forget_without_points();
    }

    void forget_without_points() {
        if (out.count == 0) {
            memory.let_go();
        }
    }

    // Makes the edges found last the contact. False where they are not what is highest and lowest
    // along their axis: edges that are nearly parallel may have an axis close to that of a face,
    // where others are; or where they miss each other: the bodies meet elsewhere, unless there is
    // `no_face`.
    bool take_edges(bool no_face = false) {
        EdgeContact edge = edge_contact(a, edges_.edge_a, b, edges_.edge_b, b_to_a_);
        const bool misses = edge.off > most_off();
        // Deeper bodies have edges that face each other, or a face that meets the other body.
        if (misses && no_face && edge.gap > -settings.hysteresis) {
            edge.look_across();
        }
        const double highest =
            misses ? settings.speculative_margin
                   : std::min(settings.speculative_margin,
                              static_cast<double>(edges_.gap) + settings.face_preference);
        if (!edge.defined || edge.gap > highest || (misses && !no_face)) {
            return false;
        }
        remember(Feature::Edges, edges_.edge_a, edges_.edge_b);
        take(edge);
        return true;
    }

    void take(const EdgeContact &edge) {
        out.count = 1;
        out.normal = pose_a.turn(edge.axis);
        out.points[0] = {edge.on_a, a_to_b_.apply(edge.on_b), edge.gap,
                         packed(Feature::Edges, memory.first, memory.second)};
        deepest_ = edge.gap;
        add_beside(edge);
    }

    // Adds the points of a face that the edges' contact is almost one of.
    void add_beside(const EdgeContact &edge) {
        const auto [is_a, face] =
            flat_face(a, memory.first, b, memory.second, edge.axis, b_to_a_, memory.last);
        if (face < 0) {
            return;
        }
        const Vec normal = is_a ? edge.axis : -a_to_b_.turn(edge.axis);
        const Vec at = is_a ? edge.on_b : a_to_b_.apply(edge.on_a);
        meet_face(is_a, face, -1);
        clip(is_a, face, incident_);
        keep_beside({at, edge.gap, normal.dot(reference(is_a).normal(face))}, settings.hysteresis,
                    settings.face_preference, scratch.clip.points);
        const int count = best_points(normal);
        for (int k = 0; k < count && out.count < MOST_POINTS; ++k) {
            out.points[out.count++] = pair_point(is_a, normal, scratch.clip.points[k]);
        }
    }

    // Finds the incident face of a reference face; `before` is kept while it
    // will do. Returns the gap above the reference face.
    double meet_face(bool is_a, int face, int before) {
        const Incident found = meet(is_a, face, before);
        incident_ = found.face;
        const Vec n = reference(is_a).normal(face);
        const Vec &t = from_incident(is_a).t;
        return found.lowest + n.x * t.x + n.y * t.y + n.z * t.z -
               static_cast<double>(reference(is_a).offset[face]);
    }

    // Makes a reference face and the incident face found for it the contact.
    void take_face(bool is_a, int face) {
        const HullData &reference = this->reference(is_a);
        auto &points = scratch.clip.points;
        const Vec normal = reference.normal(face);
        clip(is_a, face, incident_);
        deepest_ = settings.speculative_margin;
        for (const ClipPoint &point : points) {
            deepest_ = std::min(deepest_, point.gap);
        }
        const int held = best_points(normal);
        const Rigid end = may_land() ? b_to_a_ahead(*this) : b_to_a_;
        const int count = add_corners(is_a, face, end, held);
        for (int k = held; k < count; ++k) {
            deepest_ = std::min(deepest_, points[k].gap);
        }
        put(is_a, normal, points.data(), count);
        remember(face_of(is_a), face, incident_);
        remember_plane(reference, face);
    }

    // The lowest vertex above a reference face, wherever it lies beside it.
    void take_lowest(bool is_a, int face) {
        const HullData &reference = this->reference(is_a);
        ClipPoint lowest = lowest_corner(reference, face, incident(is_a), from_incident(is_a));
        lowest.id |= mark(is_a);
        put(is_a, reference.normal(face), &lowest, 1);
        remember_plane(reference, face);
        deepest_ = lowest.gap;
    }

    void put(bool is_a, const Vec &normal, const ClipPoint *points, int count) {
        out.count = count;
        turn_normal(is_a, normal);
        for (int k = 0; k < count; ++k) {
            out.points[k] = pair_point(is_a, normal, points[k]);
        }
    }
};

} // namespace

double collide_hulls(const PairCase &pair) {
    Pair(pair).run();
    const PairMemory &memory = pair.memory;
    pair.out.feature = pair.out.count > 0 ? packed(memory.feature, memory.first, memory.second) : 0;
    return memory.feature == Feature::None && memory.has_axis ? memory.widest : NOT_APART;
}

} // namespace pluvia
