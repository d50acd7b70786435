// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/running/tables/hdf5_file.hpp"

namespace hilda::studies {

void Hdf5File::open_table(bool resume)
{
    ++open_tables;
    if (storage) return;
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are exceptions, not text on stderr
    storage = std::make_unique<Hdf5Storage>(path, resume);
    const Hdf5Id access(storage->access(), H5Pclose);
    if (resume) {
        file = Hdf5Id(H5Fopen(path.c_str(), H5F_ACC_RDWR, access), H5Fclose);
        if (file < 0) throw io::IoError(path + ": cannot be read: " + library_error());
        return;
    }
    const Hdf5Id creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    check(H5Pset_istore_k(creation, 4));  // small index of chunks: 0.3 kB for each column, not 2 kB
    check(H5Pset_link_creation_order(creation, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
    file = Hdf5Id(check(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, access)), H5Fclose);
    for (const auto& [name, text] : record) attribute(file, name.c_str(), text);
}

Hdf5Id Hdf5File::group(const std::string& name, bool resume)
{
    if (resume) return {check(H5Gopen2(file, name.c_str(), H5P_DEFAULT)), H5Gclose};
    const Hdf5Id creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
    check(H5Pset_link_creation_order(creation, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
    return {check(H5Gcreate2(file, name.c_str(), H5P_DEFAULT, creation, H5P_DEFAULT)), H5Gclose};
}

void Hdf5File::attribute(hid_t object, const char* name, const std::string& text) const
{
    const Hdf5Id type(H5Tcopy(H5T_C_S1), H5Tclose), space(H5Screate(H5S_SCALAR), H5Sclose);
    check(H5Tset_size(type, H5T_VARIABLE));
    check(H5Tset_cset(type, H5T_CSET_UTF8));
    const Hdf5Id attribute(check(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT)), H5Aclose);
    const char* bytes = text.c_str();
    check(H5Awrite(attribute, type, &bytes));
}

void Hdf5File::commit()
{
    check(H5Fflush(file, H5F_SCOPE_LOCAL));
    storage->commit();
    must_commit = false;
}

void Hdf5File::close_table()
{
    if (--open_tables > 0) return;
    commit();
    check(file.close());
    storage->commit();
}

std::string Hdf5File::library_error()
{
    const char* text = nullptr;  // the callback must not throw
    H5Ewalk2(
        H5E_DEFAULT, H5E_WALK_UPWARD,
        [](unsigned n, const H5E_error2_t* e, void* to) -> herr_t {
            if (n == 0) *static_cast<const char**>(to) = e->desc;
            return 0;
        },
        &text);
    return text != nullptr ? text : "error of the HDF5 library";
}

}  // namespace hilda::studies
