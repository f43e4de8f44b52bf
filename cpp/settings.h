// A world's settings: given to Bullet, and read back from it.
#pragma once

#include "convert.h"
#include "pluvia/src/world/bullet/ffi.rs.h"

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <utility>

namespace pluvia {

// Settings as read back, one name and one number each.
class ReadBack {
  public:
    void put(const char *name, double value) {
        out_.push_back(EngineSetting{rust::String(name), value});
    }
    rust::Vec<EngineSetting> take() { return std::move(out_); }

  private:
    rust::Vec<EngineSetting> out_;
};

// Gravity, and for stock Bullet contacts the settings of Bullet's solver and narrow phase, which a
// native world reads none of. Bullet's defaults are left alone in three of them that are only read
// back: the turn ERP of split impulses, the smallest batch, and the restitution of speculative
// contacts.
void set_world(btDiscreteDynamicsWorld &world, const Units &units,
               const WorldDefinition &definition);

// The same as Bullet holds them. `stock`: those of stock Bullet contacts, too.
void read_world(const Units &units, btDiscreteDynamicsWorld &world, bool stock, ReadBack &into);

// What Bullet holds of a free body that every free body has alike. `stock`: what stock Bullet
// contacts alone act by, too.
void read_body(const Units &units, const btRigidBody &body, bool stock, ReadBack &into);

} // namespace pluvia
