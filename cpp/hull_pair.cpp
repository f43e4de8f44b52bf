#include "hull_pair.h"

#include "hull_beside.h"
#include "hull_frames.h"
#include "hull_landing.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace pluvia {

namespace {

// A gap that every feature comes up to.
constexpr double ANY = -1e30;

// Everything about the pair at hand.
class Pair : PairFrames {
  public:
    Pair(const AxisKernels &kernels, const HullData &a, const HullData &b, const Rigid &pose_a,
         const Rigid &pose_b, const PairMotion &motion, const PairSettings &settings,
         PairMemory &memory, PairScratch &scratch, PairContact &out)
        : PairFrames(kernels, a, b, pose_a, pose_b), pose_a_(pose_a), pose_b_(pose_b),
          motion_(motion), settings_(settings), memory_(memory), scratch_(scratch), out_(out) {}

    void run() {
        out_.count = 0;
        out_.held = false;
        const bool fresh = memory_.feature == Feature::None;
        now_ = smaller_pose();
        if (fresh && memory_.has_axis && still_apart()) {
            return;
        }
        if (!fresh && (memory_.recalled ? keep_recalled() : hold())) {
            return;
        }
        // No axis can have a wider gap now than this.
        const float bound = fresh ? 0 : memory_.widest + moved(memory_.pose);
        if (!fresh && keep(bound)) {
            return;
        }
        relative_ = b_to_a_.rounded();
        scratch_.axis.fit(a_, b_);
        kernels_.faces(a_, b_, relative_, scratch_.axis, faces_);
        const bool is_a = faces_.gap_a >= faces_.gap_b;
        const float widest = is_a ? faces_.gap_a : faces_.gap_b;
        if (widest > margin()) {
            part_along_face();
            return;
        }
        const float depth = fresh ? -1 : std::max(bound, -widest);
        find_edges(widest, depth);
        if (edges_.edge_a >= 0 && edges_.gap > margin()) {
            part(edges_.axis, edges_.gap);
            return;
        }
        memory_.widest = edges_.edge_a >= 0 ? edges_.gap : widest;
        memory_.pose = now_;
        if (edges_.gap <= widest + preference()) {
            edges_.edge_a = -1;
        }
        if (fresh || !keep(edges_.edge_a >= 0 ? edges_.gap : widest)) {
            choose(is_a, widest, depth);
        }
    }

  private:
    const Rigid &pose_a_;
    const Rigid &pose_b_;
    const PairMotion &motion_;
    const PairSettings &settings_;
    PairMemory &memory_;
    PairScratch &scratch_;
    PairContact &out_;
    Relative relative_;
    Relative now_; // of the smaller body
    FaceGaps faces_;
    EdgeGap edges_;
    int incident_ = -1;  // the face found last to meet a reference face
    double deepest_ = 0; // of the points made last

    float margin() const { return static_cast<float>(settings_.speculative_margin); }
    float preference() const { return static_cast<float>(settings_.face_preference); }
    // Whether the axis that parted the pair does so still.
    bool still_apart() {
        const double axis[3] = {memory_.axis[0], memory_.axis[1], memory_.axis[2]};
        memory_.widest = static_cast<float>(gap_along(axis));
        return memory_.widest > margin();
    }

    // How far any point of one body can have come in the frame of the other
    // since it was at `then`. A gap along an axis changes by no more, so the
    // widest does not either.
    float moved(const Relative &then) const {
        return farthest_way(then, now_, std::min(a_.radius, b_.radius));
    }

    // What touched when another pair found it touches still; a search might
    // find what is better by no more than it may have been then.
    bool keep_recalled() {
        memory_.pose = now_;
        const bool kept = keep(ANY);
        memory_.recalled = false;
        return kept;
    }

    // The points of the last step, at the gaps they have now; of edges, where
    // they come closest now. False where there are none.
    bool hold() {
        if (memory_.feature == Feature::Edges) {
            return moved(memory_.pose) <= settings_.hold && keep_edges(ANY);
        }
        // Corners that were out of the margin then may land now.
        const bool farther =
            settings_.speculative_margin > static_cast<double>(memory_.met_margin) + settings_.hold;
        if (memory_.last.count == 0 || farther || moved(memory_.met_at) > settings_.hold) {
            return false;
        }
        const bool is_a = memory_.feature == Feature::FaceOfA;
        const double normal[3] = {memory_.plane_normal[0], memory_.plane_normal[1],
                                  memory_.plane_normal[2]};
        ClipPoint points[MOST_POINTS];
        for (int i = 0; i < memory_.last.count; ++i) {
            const KeptPoint &before = memory_.last.points[i];
            ClipPoint &point = points[i];
            from_incident(is_a).apply(is_a ? before.on_b : before.on_a, point.x);
            point.gap = normal[0] * point.x[0] + normal[1] * point.x[1] + normal[2] * point.x[2] -
                        static_cast<double>(memory_.plane_offset);
            point.id = before.id;
        }
        put(is_a, normal, points, memory_.last.count);
        out_.held = true;
        return true;
    }

    void find_edges(float best, float depth) {
        kernels_.edges(a_, b_, relative_, faces_, best, margin(), depth, scratch_.axis, edges_);
    }

    // Apart by more than the speculative margin along an axis.
    void part(const float axis[3], float gap) {
        memory_.widest = gap;
        memory_.feature = Feature::None;
        memory_.has_axis = true;
        std::copy(axis, axis + 3, memory_.axis);
    }

    void part_along_face() {
        if (faces_.gap_a >= faces_.gap_b) {
            const int f = faces_.face_a;
            const float axis[3] = {a_.nx[f], a_.ny[f], a_.nz[f]};
            part(axis, faces_.gap_a);
        } else {
            const AxisScratch &s = scratch_.axis;
            const int f = faces_.face_b;
            const float axis[3] = {-s.bnx[f], -s.bny[f], -s.bnz[f]};
            part(axis, faces_.gap_b);
        }
    }

    // Goes on with the feature of the last step if it is nearly the best and
    // its points bear it out.
    bool keep(double best) {
        const double least = best - settings_.hysteresis;
        if (memory_.feature == Feature::Edges) {
            return keep_edges(least);
        }
        const bool is_a = memory_.feature == Feature::FaceOfA;
        const double gap = meet_face(is_a, memory_.first, memory_.second);
        if (gap < least) {
            return false;
        }
        take_face(is_a, memory_.first);
        // What is recalled may have been held for longer than a search would keep it.
        return out_.count > 0 && (memory_.recalled || deepest_ <= gap + settings_.hysteresis);
    }

    bool keep_edges(double least) {
        const double slack = settings_.hysteresis;
        const EdgeContact edge = edge_contact(a_, memory_.first, b_, memory_.second, b_to_a_);
        if (!edge.defined || edge.off > slack) {
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
        const PairFace passed =
            passing_face(kernels_, a_, b_, pose_a_, pose_b_, motion_, settings_.hysteresis,
                         {is_a, face}, scratch_.axis, scratch_.ahead);
        meet_face(passed.is_a, passed.face, -1);
        take_face(passed.is_a, passed.face);
        if (passed != PairFace{is_a, face}) {
            forget_without_points();
            return;
        }
        if (out_.count > 0 && deepest_ <= static_cast<double>(widest) + settings_.face_preference) {
            return;
        }
        // The face's plane is as good as any axis, but no face of the other
        // body lies against it: edges that are hardly worse, then.
        find_edges(widest - preference(), depth);
        if (edges_.edge_a >= 0 && edges_.gap > margin()) {
            out_.count = 0;
            part(edges_.axis, edges_.gap);
            return;
        }
        if (edges_.edge_a >= 0 && take_edges()) {
            return;
        }
        if (out_.count == 0 && widest < 0) {
            take_lowest(is_a, face);
        }
        forget_without_points();
    }

    void forget_without_points() {
        if (out_.count == 0) {
            memory_.feature = Feature::None;
            memory_.has_axis = false;
        }
    }

    void remember(Feature feature, int first, int second) {
        memory_.feature = feature;
        memory_.first = first;
        memory_.second = second;
    }

    // What `hold` goes on with.
    void remember_plane(const HullData &reference, int face) {
        memory_.met_at = now_;
        memory_.met_margin = margin();
        memory_.plane_normal[0] = reference.nx[face];
        memory_.plane_normal[1] = reference.ny[face];
        memory_.plane_normal[2] = reference.nz[face];
        memory_.plane_offset = reference.offset[face];
    }

    // Makes the edges found last the contact. False where they are not what
    // is highest and lowest along their axis: edges that are nearly parallel
    // may have an axis close to that of a face, where others are.
    bool take_edges() {
        const EdgeContact edge = edge_contact(a_, edges_.edge_a, b_, edges_.edge_b, b_to_a_);
        const double highest = std::min(static_cast<double>(edges_.gap) + settings_.face_preference,
                                        settings_.speculative_margin);
        if (!edge.defined || edge.gap > highest) {
            return false;
        }
        remember(Feature::Edges, edges_.edge_a, edges_.edge_b);
        take(edge);
        return true;
    }

    void take(const EdgeContact &edge) {
        out_.count = 1;
        pose_a_.turn(edge.axis, out_.normal);
        PairPoint &point = out_.points[0];
        std::copy(edge.on_a, edge.on_a + 3, point.on_a);
        a_to_b_.apply(edge.on_b, point.on_b);
        point.gap = edge.gap;
        point.id = FROM_EDGES | (static_cast<std::uint32_t>(memory_.first) & 0x3fffU) << 14 |
                   (static_cast<std::uint32_t>(memory_.second) & 0x3fffU);
        deepest_ = edge.gap;
        add_beside(edge);
    }

    // Adds the points of a face that the edges' contact is almost one of.
    void add_beside(const EdgeContact &edge) {
        const auto [is_a, face] =
            flat_face(a_, memory_.first, b_, memory_.second, edge.axis, b_to_a_, memory_.last);
        if (face < 0) {
            return;
        }
        double normal[3], at[3];
        if (is_a) {
            std::copy(edge.axis, edge.axis + 3, normal);
            std::copy(edge.on_b, edge.on_b + 3, at);
        } else {
            a_to_b_.turn(edge.axis, normal);
            a_to_b_.apply(edge.on_a, at);
            std::transform(normal, normal + 3, normal, std::negate<>());
        }
        meet_face(is_a, face, -1);
        const HullData &reference = this->reference(is_a);
        const double cosine = normal[0] * reference.nx[face] + normal[1] * reference.ny[face] +
                              normal[2] * reference.nz[face];
        const int count = clip(is_a, face, normal, [&](auto &points) {
            keep_beside({at, edge.gap, cosine}, settings_.hysteresis, settings_.face_preference,
                        points);
        });
        for (int k = 0; k < count && out_.count < MOST_POINTS; ++k) {
            out_.points[out_.count++] = pair_point(is_a, normal, scratch_.clip.points[k]);
        }
    }

    // Finds the incident face of a reference face; `before` is kept while it
    // will do. Returns the gap above the reference face.
    double meet_face(bool is_a, int face, int before) {
        const HullData &reference = this->reference(is_a);
        const double normal[3] = {reference.nx[face], reference.ny[face], reference.nz[face]};
        double seen[3];
        to_incident(is_a).turn(normal, seen);
        const Incident found = incident_face(incident(is_a), seen, before, settings_.hysteresis);
        incident_ = memory_.recalled && before >= 0 ? before : found.face;
        const double *t = from_incident(is_a).t;
        return found.lowest + normal[0] * t[0] + normal[1] * t[1] + normal[2] * t[2] -
               static_cast<double>(reference.offset[face]);
    }

    // The points of a reference face and the incident face found for it that hold the
    // bodies best, of those that `choose` leaves. Returns their number.
    template <class Choose>
    int clip(bool is_a, int face, const double normal[3], const Choose &choose) {
        auto &points = scratch_.clip.points;
        clip_face(reference(is_a), face, incident(is_a), incident_, from_incident(is_a),
                  settings_.speculative_margin, scratch_.clip);
        for (ClipPoint &point : points) {
            point.id |= mark(is_a);
        }
        choose(points);
        std::uint32_t known[MOST_POINTS];
        for (int i = 0; i < memory_.last.count; ++i) {
            known[i] = memory_.last.points[i].id;
        }
        const double slack = settings_.hysteresis;
        const int before = memory_.last.count;
        return memory_.recalled ? keep_points(points, slack, known, before)
                                : reduce_points(points, normal, settings_.speculative_margin, slack,
                                                known, before);
    }

    // Makes a reference face and the incident face found for it the contact.
    void take_face(bool is_a, int face) {
        const HullData &reference = this->reference(is_a);
        auto &points = scratch_.clip.points;
        const double normal[3] = {reference.nx[face], reference.ny[face], reference.nz[face]};
        deepest_ = settings_.speculative_margin;
        int count = clip(is_a, face, normal, [this](const auto &all) {
            for (const ClipPoint &point : all) {
                deepest_ = std::min(deepest_, point.gap);
            }
        });
        if (settings_.approach > settings_.speculative_margin / 2) {
            const Rigid ahead = b_to_a_ahead(pose_a_, pose_b_, motion_);
            const Rigid end = is_a ? ahead : ahead.inverse();
            count =
                add_landing({reference, face, incident(is_a), from_incident(is_a), end, mark(is_a)},
                            settings_.speculative_margin, settings_.hysteresis, points, count);
        }
        put(is_a, normal, points.data(), count);
        remember(is_a ? Feature::FaceOfA : Feature::FaceOfB, face, incident_);
        remember_plane(reference, face);
    }

    // The lowest vertex above a reference face, wherever it lies beside it.
    void take_lowest(bool is_a, int face) {
        const HullData &reference = this->reference(is_a);
        const double normal[3] = {reference.nx[face], reference.ny[face], reference.nz[face]};
        ClipPoint lowest = lowest_corner(reference, face, incident(is_a), from_incident(is_a));
        lowest.id |= mark(is_a);
        put(is_a, normal, &lowest, 1);
        remember_plane(reference, face);
        deepest_ = lowest.gap;
    }

    void put(bool is_a, const double normal[3], const ClipPoint *points, int count) {
        out_.count = count;
        double turned[3];
        (is_a ? pose_a_ : pose_b_).turn(normal, turned);
        for (int i = 0; i < 3; ++i) {
            out_.normal[i] = is_a ? turned[i] : -turned[i];
        }
        for (int k = 0; k < count; ++k) {
            out_.points[k] = pair_point(is_a, normal, points[k]);
        }
    }
};

} // namespace

void collide(const AxisKernels &kernels, const HullData &a, const HullData &b, const Rigid &pose_a,
             const Rigid &pose_b, const PairMotion &motion, const PairSettings &settings,
             PairMemory &memory, PairScratch &scratch, PairContact &out) {
    Pair(kernels, a, b, pose_a, pose_b, motion, settings, memory, scratch, out).run();
    out.feature = out.count > 0 ? packed(memory.feature, memory.first, memory.second) : 0;
}

} // namespace pluvia
