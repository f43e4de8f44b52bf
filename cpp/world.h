// One btDiscreteDynamicsWorld with all it needs, behind the functions of the
// bridge in src/world/bullet/ffi.rs.
#pragma once

#include "rust/cxx.h"

#include <cstdint>
#include <memory>

namespace pluvia {

struct BodyDefinition;
struct BodyRead;
struct ContactRead;
struct DriveRead;
struct BodyPose;
struct EngineSetting;
struct PairValue;
struct PhaseTimes;
struct PressDefinition;
struct ShapeDefinition;
struct WorldDefinition;

class BulletWorld {
  public:
    BulletWorld(const WorldDefinition &definition, rust::Slice<const PairValue> pairs);
    ~BulletWorld();

    std::uint32_t add_shape(const ShapeDefinition &definition);
    std::uint32_t add_body(const BodyDefinition &definition);
    void remove_body(std::uint32_t id);
    void drive_body(std::uint32_t id, const BodyPose &end);
    void recall_drive(std::uint32_t id, rust::Slice<const BodyPose> ends);
    void press_body(std::uint32_t id, const PressDefinition &definition);
    void set_force(std::uint32_t id, double force);
    void join_body(std::uint32_t id, std::uint32_t whole);
    void step(bool alone);
    BodyRead read_one_body(std::uint32_t id) const;
    void read_bodies(rust::Vec<BodyRead> &out) const;
    void read_corners(rust::Vec<std::uint32_t> &counts, rust::Vec<double> &coordinates,
                      rust::Vec<double> &roundings) const;
    void read_drives(rust::Vec<DriveRead> &out) const;
    void read_contacts(rust::Vec<ContactRead> &out) const;
    void find_contacts();
    void remember_contacts(rust::Vec<ContactRead> &out) const;
    void recall_contacts(rust::Slice<const ContactRead> contacts);
    PhaseTimes phases() const;
    double solver_residual() const;
    void record_substeps();
    void read_substep(rust::Vec<double> &bodies, rust::Vec<double> &contacts) const;
    PairValue pair_value(std::uint32_t a, std::uint32_t b) const;
    rust::Vec<EngineSetting> effective() const;

  private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

std::unique_ptr<BulletWorld> new_world(const WorldDefinition &definition,
                                       rust::Slice<const PairValue> pairs);

} // namespace pluvia
