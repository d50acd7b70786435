// SPDX-License-Identifier: GPL-3.0-or-later
/// Columns of four numbers, of which the blocks of the condensed solver consist.

#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace hilda::lie {

using Column = double __attribute__((vector_size(4 * sizeof(double))));

/// Allocates with the alignment that functions compiled for AVX2 expect. That of the type is only 16 in the
/// other functions.
template <class T>
struct ColumnAllocator {
    using value_type = T;
    static constexpr std::align_val_t alignment{sizeof(Column)};

    T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), alignment)); }
    void deallocate(T* columns, std::size_t) { ::operator delete(columns, alignment); }
    bool operator==(const ColumnAllocator&) const { return true; }
};

using Columns = std::vector<Column, ColumnAllocator<Column>>;

}  // namespace hilda::lie
