// What bindgen reads of Bullet: its version, enums and constants, so that none is retyped in Rust.
#pragma once

#include <btBulletDynamicsCommon.h>

constexpr int PLUVIA_BULLET_VERSION = BT_BULLET_VERSION;
constexpr int PLUVIA_SCALAR_BYTES = static_cast<int>(sizeof(btScalar));
