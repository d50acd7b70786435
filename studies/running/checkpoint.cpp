// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/running/checkpoint.hpp"

#include "io/files.hpp"
#include "io/message.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstdio>
#include <cstring>
#include <filesystem>

namespace hilda::studies {

namespace {

static_assert(std::endian::native == std::endian::little, "checkpoints are little endian");

constexpr char magic[8] = {'H', 'I', 'L', 'D', 'A', 'C', 'K', 'P'};
constexpr std::uint64_t format_version = 6;
constexpr size_t header_bytes = sizeof magic + 2 * sizeof(std::uint64_t),
                 checksum_bytes = sizeof(std::uint32_t);

/// CRC-32 as in zlib and PNG
std::uint32_t crc32(const char* bytes, size_t count)
{
    static const auto table = [] {
        std::array<std::uint32_t, 256> t{};
        for (std::uint32_t k = 0; k < 256; ++k) {
            t[k] = k;
            for (int bit = 0; bit < 8; ++bit) t[k] = (t[k] >> 1) ^ ((t[k] & 1) != 0 ? 0xEDB88320u : 0u);
        }
        return t;
    }();
    std::uint32_t crc = ~0u;
    for (size_t k = 0; k < count; ++k)
        crc = table[(crc ^ static_cast<unsigned char>(bytes[k])) & 0xFF] ^ (crc >> 8);
    return ~crc;
}

/// Appends values to a byte string
struct OutputArchive {
    std::string bytes;

    void raw(const void* from, size_t count) { bytes.append(static_cast<const char*>(from), count); }
    /// Writes the length of a list. `each` is the size of an item [byte], used by InputArchive only.
    size_t count(size_t n, size_t /*each*/)
    {
        const auto wide = static_cast<std::uint64_t>(n);
        raw(&wide, sizeof wide);
        return n;
    }
};

/// Reads values from a byte string. io::IoError if the bytes end too early.
struct InputArchive {
    const char* at;
    const char* end;
    const std::string& file;

    void raw(void* to, size_t count)
    {
        if (static_cast<size_t>(end - at) < count)
            throw io::IoError(file + ": the checkpoint is damaged: unexpected end of data");
        if (count > 0) std::memcpy(to, at, count);
        at += count;
    }
    size_t count(size_t, size_t each)
    {
        std::uint64_t n = 0;
        raw(&n, sizeof n);
        if (n > static_cast<size_t>(end - at) / each)
            throw io::IoError(file + ": the checkpoint is damaged: invalid length of a list");
        return n;
    }
};

template <class Archive, class Number>
requires std::is_arithmetic_v<Number>
void transfer(Archive& a, Number& value) { a.raw(&value, sizeof value); }

template <class Archive, class List>
void transfer_list(Archive& a, List& list)
{
    list.resize(static_cast<decltype(list.size())>(a.count(list.size(), sizeof list[0])));
    a.raw(list.data(), list.size() * sizeof list[0]);
}

template <class Archive>
void transfer(Archive& a, lie::State& x)
{
    static_assert(sizeof(lie::Motion) == 24 * sizeof(double),
                  "a motion must consist of 24 numbers without padding");
    transfer(a, x.t);
    transfer_list(a, x.body);
    transfer_list(a, x.alpha);
    transfer_list(a, x.lambda);
    transfer_list(a, x.discrete_state);
    transfer_list(a, x.internal_state);
    transfer_list(a, x.history);
}

constexpr size_t bytes_of_event = 2 * sizeof(int) + 2 * sizeof(double);

template <class Archive>
void transfer(Archive& a, contact::ContactEvent& e)
{
    auto kind = static_cast<int>(e.type);
    transfer(a, kind);
    e.type = static_cast<contact::ContactEvent::Type>(kind);
    transfer(a, e.t);
    transfer(a, e.contact);
    transfer(a, e.speed);
}

/// Writes or reads the content of a checkpoint, depending on Archive
template <class Archive>
void transfer(Archive& a, Checkpoint& c)
{
    transfer_list(a, c.settings);
    transfer(a, c.node);
    transfer(a, c.number);
    transfer(a, c.iterations);
    transfer(a, c.pivots);
    for (long* n : {&c.statistics.steps, &c.statistics.iterations, &c.statistics.factorizations,
                    &c.statistics.refactorizations, &c.invariants.nodes, &c.invariants.rows,
                    &c.last_step.factorizations, &c.last_step.wall_ns})
        transfer(a, *n);
    for (double* v : {&c.invariants.energy_start, &c.invariants.energy_end, &c.invariants.energy_drift,
                      &c.invariants.constraint_norm, &c.invariants.orthogonality, &c.wall_seconds,
                      &c.last_step.correction})
        transfer(a, *v);
    transfer_list(a, c.invariants.contact);
    c.contacts.events.resize(a.count(c.contacts.events.size(), bytes_of_event));
    for (contact::ContactEvent& e : c.contacts.events) transfer(a, e);
    transfer_list(a, c.contacts.node_forces);
    transfer(a, c.trajectory_bytes);
    transfer(a, c.steps_bytes);
}

}  // namespace

std::string to_bytes(const Checkpoint& checkpoint)
{
    OutputArchive a;
    std::uint64_t version = format_version, length = 0;
    a.raw(magic, sizeof magic);
    transfer(a, version);
    transfer(a, length);
    Checkpoint copy = checkpoint;  // transfer() serves both directions and needs a non-const object
    transfer(a, copy);
    length = a.bytes.size() + checksum_bytes;
    std::memcpy(a.bytes.data() + sizeof magic + sizeof version, &length, sizeof length);
    std::uint32_t crc = crc32(a.bytes.data(), a.bytes.size());
    transfer(a, crc);
    return std::move(a.bytes);
}

Checkpoint from_bytes(const std::string& bytes, const std::string& file)
{
    const auto damaged = [&](const std::string& how) {
        return io::IoError(file + ": the checkpoint is damaged: " + how);
    };
    if (bytes.size() < header_bytes + checksum_bytes || std::memcmp(bytes.data(), magic, sizeof magic) != 0)
        throw damaged("the header is not that of a checkpoint");
    InputArchive a{bytes.data() + sizeof magic, bytes.data() + bytes.size(), file};
    std::uint64_t version = 0, length = 0;
    transfer(a, version);
    transfer(a, length);
    std::uint32_t crc = 0;
    std::memcpy(&crc, bytes.data() + bytes.size() - checksum_bytes, sizeof crc);
    if (length != bytes.size())
        throw damaged(fmt::format("its length must be {} bytes, got {}", length, bytes.size()));
    if (crc != crc32(bytes.data(), bytes.size() - checksum_bytes)) throw damaged("wrong checksum");
    if (version != format_version)
        throw io::IoError(fmt::format("{}: the checkpoint has format {}; this program reads format {}", file,
                                      version, format_version));

    a.end -= checksum_bytes;
    Checkpoint c;
    transfer(a, c);
    if (a.at != a.end) throw damaged("unread bytes after the content");
    return c;
}

namespace {

struct FileNames {
    explicit FileNames(const std::string& directory)
        : last(directory + "/checkpoint"), before(last + ".1"), next(last + ".new")
    {}

    std::string last, before, next;
};

constexpr size_t largest_file = size_t{1} << 32;

bool exists(const std::string& file)
{
    std::error_code error;
    return std::filesystem::exists(file, error);
}

}  // namespace

void save(const Checkpoint& checkpoint, const std::string& directory)
{
    const FileNames names(directory);
    io::write_file(names.next, to_bytes(checkpoint));
    if (exists(names.last)) io::rename_file(names.last, names.before);
    io::rename_file(names.next, names.last);
}

std::optional<Checkpoint> load(const std::string& directory)
{
    const FileNames names(directory);
    if (!exists(names.last) && !exists(names.before)) return {};
    try {
        return from_bytes(io::read_file(names.last, largest_file), names.last);
    } catch (const io::IoError& error) {
        if (!exists(names.before)) throw;
        io::warning(std::string(error.what()) + "; resuming from the previous checkpoint");
    }
    return from_bytes(io::read_file(names.before, largest_file), names.before);
}

void remove_checkpoints(const std::string& directory)
{
    const FileNames names(directory);
    for (const std::string& file : {names.last, names.before, names.next}) std::remove(file.c_str());
}

std::uint64_t hash(const std::string& text)
{
    std::uint64_t h = 0xcbf29ce484222325u;
    for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    return h;
}

}  // namespace hilda::studies
