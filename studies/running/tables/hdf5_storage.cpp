// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/running/tables/hdf5_storage.hpp"

#include "io/archive.hpp"
#include "io/files.hpp"

#if H5_VERSION_GE(1, 13, 0)
#include <H5FDdevelop.h>
#endif

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <limits>
#include <memory>

namespace hilda::studies {

namespace {

constexpr io::Archive::Format journal_format = {.letters = "HILDAH5J", .version = 1};

/// What the file access property list has for the driver
struct DriverInfo {
    Hdf5Storage* storage;
};

/// The library's view of the storage. `base` is first, so that a pointer to it is a pointer to this.
struct DriverFile {
    H5FD_t base;
    Hdf5Storage* storage;
};

Hdf5Storage& storage_of(const H5FD_t* file) { return *reinterpret_cast<const DriverFile*>(file)->storage; }

/// Calls a function that may throw (memory only: errors of files are returned). The library is written in C.
template <class Function>
herr_t guarded(const Function& function)
{
    try {
        return function() ? 0 : -1;
    } catch (...) {
        return -1;
    }
}

H5FD_t* open_file(const char*, unsigned flags, hid_t access, haddr_t)
{
    const void* info = H5Pget_driver_info(access);
    if (info == nullptr) return nullptr;
    std::unique_ptr<DriverFile> file;
    const herr_t result = guarded([&] {
        file = std::make_unique<DriverFile>();
        file->storage = static_cast<const DriverInfo*>(info)->storage;
        return (flags & H5F_ACC_TRUNC) == 0 || file->storage->clear();
    });
    return result < 0 ? nullptr : &file.release()->base;
}

herr_t close_file(H5FD_t* file)
{
    delete reinterpret_cast<DriverFile*>(file);
    return 0;
}

herr_t query(const H5FD_t*, unsigned long* flags)
{
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
    return 0;
}

haddr_t get_allocated_end(const H5FD_t* file, H5FD_mem_t) { return storage_of(file).allocated_end(); }

herr_t set_allocated_end(H5FD_t* file, H5FD_mem_t, haddr_t at)
{
    storage_of(file).set_end(at);
    return 0;
}

haddr_t get_written_end(const H5FD_t* file, H5FD_mem_t)
{
    return std::max(storage_of(file).written_end(), storage_of(file).allocated_end());
}

herr_t read_bytes(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, size_t count, void* to)
{
    return guarded([&] { return storage_of(file).read(at, count, static_cast<char*>(to)); });
}

herr_t write_bytes(H5FD_t* file, H5FD_mem_t type, hid_t, haddr_t at, size_t count, const void* from)
{
    return guarded([&] {
        return storage_of(file).write(type == H5FD_MEM_DRAW, at, count, static_cast<const char*>(from));
    });
}

/// Raw data and metadata have separate lists of free space.
hid_t driver()
{
    static const hid_t id = [] {
        static H5FD_class_t c{};
        const H5FD_mem_t free_lists[] = H5FD_FLMAP_DICHOTOMY;
#ifdef H5FD_CLASS_VERSION
        c.version = H5FD_CLASS_VERSION;
        c.value = static_cast<H5FD_class_value_t>(H5_VFD_RESERVED + 104);
#endif
        c.name = "hilda";
        c.maxaddr = static_cast<haddr_t>(std::numeric_limits<off_t>::max());
        c.fc_degree = H5F_CLOSE_STRONG;
        c.fapl_size = sizeof(DriverInfo);
        c.open = open_file;
        c.close = close_file;
        c.query = query;
        c.get_eoa = get_allocated_end;
        c.set_eoa = set_allocated_end;
        c.get_eof = get_written_end;
        c.read = read_bytes;
        c.write = write_bytes;
        std::copy(std::begin(free_lists), std::end(free_lists), c.fl_map);
        return H5FDregister(&c);
    }();
    return id;
}

/// Calls use(bytes, offset, length) for each part of the held bytes within the `count` bytes from the address
/// `at`. `offset` is the distance of the part from `at`.
template <class Use>
void for_overlaps(std::map<std::uint64_t, std::string>& held, std::uint64_t at, size_t count, const Use& use)
{
    auto entry = held.upper_bound(at);
    if (entry != held.begin()) --entry;
    for (; entry != held.end() && entry->first < at + count; ++entry) {
        const std::uint64_t first = std::max(at, entry->first),
                            last = std::min(at + count, entry->first + entry->second.size());
        if (first < last) use(entry->second.data() + (first - entry->first), first - at, last - first);
    }
}

[[noreturn]] void fail(const std::string& path, const char* what)
{
    throw io::IoError(path + ": " + what + ": " + std::strerror(errno));
}

}  // namespace

Hdf5Storage::Hdf5Storage(std::string file, bool resume) : path(std::move(file))
{
    descriptor = open(path.c_str(), O_RDWR | O_CLOEXEC | (resume ? 0 : O_CREAT | O_TRUNC), 0666);
    if (descriptor < 0) fail(path, "cannot be written");
    try {
        struct stat s {};
        if (fstat(descriptor, &s) != 0) fail(path, "cannot be read");
        written = static_cast<std::uint64_t>(s.st_size);
        const std::string journal = path + ".journal";
        if (::access(journal.c_str(), F_OK) != 0) return;
        if (resume)
            complete(journal);
        else if (unlink(journal.c_str()) != 0)
            fail(journal, "cannot be removed");
    } catch (...) {
        close(descriptor);
        throw;
    }
}

Hdf5Storage::~Hdf5Storage() { close(descriptor); }

hid_t Hdf5Storage::access()
{
    const hid_t list = H5Pcreate(H5P_FILE_ACCESS);
    const DriverInfo info{this};
    // Without the driver the library would write the file itself, without transactions.
    if (H5Pset_driver(list, driver(), &info) < 0 || H5Pset_fclose_degree(list, H5F_CLOSE_STRONG) < 0 ||
        H5Pset_libver_bounds(list, H5F_LIBVER_V18, H5F_LIBVER_V18) < 0) {  // readable by HDF5 1.8 (2008)
        H5Pclose(list);
        throw io::IoError(path + ": the HDF5 library does not accept the file driver");
    }
    return list;
}

bool Hdf5Storage::clear()
{
    held.clear();
    end = written = 0;
    return discarding || ftruncate(descriptor, 0) == 0 || failed();
}

/// Notes the first error. Everything after it is discarded, so that the library can close the file.
bool Hdf5Storage::failed()
{
    if (error_text.empty()) error_text = errno == 0 ? "no space" : std::strerror(errno);
    discarding = true;
    return false;
}

bool Hdf5Storage::read(std::uint64_t at, size_t count, char* to)
{
    std::memset(to, 0, count);  // bytes beyond the end of the file, as in the drivers of the library
    for (size_t done = 0; done < count;) {
        const ssize_t n = pread(descriptor, to + done, count - done, static_cast<off_t>(at + done));
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return failed();
        if (n == 0) break;
        done += static_cast<size_t>(n);
    }
    for_overlaps(held, at, count, [&](char* bytes, std::uint64_t offset, size_t length) {
        std::memcpy(to + offset, bytes, length);
    });
    return true;
}

bool Hdf5Storage::write(bool raw, std::uint64_t at, size_t count, const char* from)
{
    if (discarding) return true;
    written = std::max(written, at + count);
    if (!raw) {
        hold(at, count, from);
        return true;
    }
    raw_bytes += count;
    patch(at, count, from);
    return write_at(at, count, from);
}

bool Hdf5Storage::write_at(std::uint64_t at, size_t count, const char* from)
{
    for (size_t done = 0; done < count;) {
        errno = 0;
        const ssize_t n = pwrite(descriptor, from + done, count - done, static_cast<off_t>(at + done));
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return failed();
        done += static_cast<size_t>(n);
    }
    return true;
}

/// Adds metadata to `held`, joined with the entries that it overlaps.
void Hdf5Storage::hold(std::uint64_t at, size_t count, const char* from)
{
    std::uint64_t start = at;
    std::string bytes(from, count);
    auto entry = held.upper_bound(at);
    if (entry != held.begin() && std::prev(entry)->first + std::prev(entry)->second.size() > at) --entry;
    while (entry != held.end() && entry->first < at + count) {
        const std::string& old = entry->second;
        const std::uint64_t old_end = entry->first + old.size(), new_end = start + bytes.size();
        if (old_end > new_end) bytes.append(old, new_end - entry->first);
        if (entry->first < start) {
            bytes.insert(0, old, 0, start - entry->first);
            start = entry->first;
        }
        entry = held.erase(entry);
    }
    held[start] = std::move(bytes);
}

/// Raw data in space that was metadata: the held bytes must not overwrite it.
void Hdf5Storage::patch(std::uint64_t at, size_t count, const char* from)
{
    for_overlaps(held, at, count, [&](char* bytes, std::uint64_t offset, size_t length) {
        std::memcpy(bytes, from + offset, length);
    });
}

void Hdf5Storage::commit()
{
    const auto check = [&](bool success) {
        if (!success && error_text.empty()) failed();
        if (!error_text.empty()) throw io::IoError(path + ": cannot be written: " + error_text);
    };
    check(error_text.empty());
    if (discarding) return;
    const auto synchronised = [&] { return fdatasync(descriptor) == 0 || errno == EINVAL || errno == EROFS; };
    check(synchronised());
    raw_bytes = 0;
    if (held.empty()) return;
    io::Archive a(journal_format);
    a.value(end);
    size_t count = held.size();
    a.count(count, sizeof(std::uint64_t));
    for (auto& [at, bytes] : held) {
        std::uint64_t address = at;
        a.value(address);
        a.list(bytes);
    }
    const std::string journal = path + ".journal";
    io::write_file(journal, a.bytes());
    apply();
    check(error_text.empty() && synchronised());
    if (unlink(journal.c_str()) != 0) fail(journal, "cannot be removed");
}

/// Writes the held metadata to the file. The length of the file becomes that of the allocated space.
void Hdf5Storage::apply()
{
    for (const auto& [at, bytes] : held)
        if (!write_at(at, bytes.size(), bytes.data())) return;
    if (ftruncate(descriptor, static_cast<off_t>(end)) != 0) failed();
    written = end;
    held.clear();
}

void Hdf5Storage::complete(const std::string& journal)
{
    constexpr size_t most = size_t{1} << 32;
    const std::string bytes = io::read_file(journal, most);
    io::Archive a(journal_format, bytes, journal);
    a.value(end);
    size_t count = 0;
    a.count(count, sizeof(std::uint64_t));
    for (size_t k = 0; k < count; ++k) {
        std::uint64_t address = 0;
        a.value(address);
        a.list(held[address]);
    }
    a.end();
    apply();
    if (!error_text.empty() || fdatasync(descriptor) != 0 || unlink(journal.c_str()) != 0)
        throw io::IoError(path +
                          ": cannot be written: " + (error_text.empty() ? std::strerror(errno) : error_text));
}

}  // namespace hilda::studies
