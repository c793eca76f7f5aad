// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <petscsnes.h>

#include <utility>

namespace gaiter::petsc {

// Sole owner of one reference to a PETSc object: moves, never copies; does nothing once PETSc is finalised.
template <typename T, PetscErrorCode (*Destroy)(T*)>
class Handle {
 public:
  Handle() = default;
  explicit Handle(T object) : object_(object) {}
  Handle(Handle&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      reset();
      object_ = std::exchange(other.object_, nullptr);
    }
    return *this;
  }
  ~Handle() { reset(); }

  T get() const { return object_; }
  // For functions that create an object through a pointer; what was held before is let go.
  T* out() {
    reset();
    return &object_;
  }

 private:
  void reset() {
    PetscBool finalized = PETSC_FALSE;
    if (object_ && PetscFinalized(&finalized) == 0 && !finalized) (void)Destroy(&object_);
    object_ = nullptr;
  }

  T object_ = nullptr;
};

using Snes = Handle<SNES, SNESDestroy>;
using Vector = Handle<Vec, VecDestroy>;
using Matrix = Handle<Mat, MatDestroy>;

}  // namespace gaiter::petsc
