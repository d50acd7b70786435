// SPDX-License-Identifier: GPL-3.0-or-later
/// Ownership of the objects of SUNDIALS.

#pragma once

#include <Eigen/Core>

#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_klu.h>
#include <sunmatrix/sunmatrix_sparse.h>

#include <memory>
#include <new>
#include <type_traits>

namespace hilda::reference {

/// Calls a function of SUNDIALS to destroy an object.
template <auto destroy>
struct Destroy {
    template <class T>
    void operator()(T* p) const
    {
        destroy(p);
    }
};

inline void free_context(SUNContext context) { SUNContext_Free(&context); }
inline void free_ida(void* ida_memory) { IDAFree(&ida_memory); }

template <class Handle, auto destroy>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Destroy<destroy>>;

/// The handle of a new object. Throws std::bad_alloc if there is none.
template <class Handle>
Handle allocated(Handle handle)
{
    if (handle == nullptr) throw std::bad_alloc();
    return handle;
}

/// The numbers of a vector
inline Eigen::Map<Eigen::VectorXd> map(N_Vector v) { return {N_VGetArrayPointer(v), N_VGetLength(v)}; }

inline SUNContext new_context()
{
    SUNContext context = nullptr;
    if (SUNContext_Create(nullptr, &context) != 0) throw std::bad_alloc();
    return context;
}

}  // namespace hilda::reference
