// Vectors that leave unset what they grow by.
#pragma once

#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace pluvia {

// As std::allocator, but an element that `resize` adds keeps what its memory
// held: for what is written whole before it is read.
template <class T> struct Unset : std::allocator<T> {
    template <class U> struct rebind { using other = Unset<U>; };
    template <class U> void construct(U *at) { ::new (static_cast<void *>(at)) U; }
    template <class U, class... Of> void construct(U *at, Of &&...of) {
        ::new (static_cast<void *>(at)) U(std::forward<Of>(of)...);
    }
};

template <class T> using UnsetVector = std::vector<T, Unset<T>>;

} // namespace pluvia
