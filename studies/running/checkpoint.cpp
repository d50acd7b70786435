// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/running/checkpoint.hpp"

#include "studies/message.hpp"
#include "studies/output.hpp"

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
constexpr std::uint64_t format = 5;
constexpr size_t head = sizeof magic + 2 * sizeof(std::uint64_t), tail = sizeof(std::uint32_t);

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

/// Puts values into bytes
struct Pack {
    std::string bytes;

    void raw(const void* from, size_t count) { bytes.append(static_cast<const char*>(from), count); }
    /// A number of items, each of so many bytes
    size_t count(size_t n, size_t /*each*/)
    {
        const auto wide = static_cast<std::uint64_t>(n);
        raw(&wide, sizeof wide);
        return n;
    }
};

/// Takes them out again
struct Unpack {
    const char* at;
    const char* end;
    const std::string& file;

    void raw(void* to, size_t count)
    {
        if (static_cast<size_t>(end - at) < count)
            throw IoError(file + ": the checkpoint is damaged: it ends too early");
        if (count > 0) std::memcpy(to, at, count);
        at += count;
    }
    size_t count(size_t, size_t each)
    {
        std::uint64_t n = 0;
        raw(&n, sizeof n);
        if (n > static_cast<size_t>(end - at) / each)
            throw IoError(file + ": the checkpoint is damaged: a list is too long");
        return n;
    }
};

template <class Archive, class Number>
requires std::is_arithmetic_v<Number>
void pass(Archive& a, Number& value) { a.raw(&value, sizeof value); }

template <class Archive, class List>
void pass_list(Archive& a, List& list)
{
    list.resize(static_cast<decltype(list.size())>(a.count(list.size(), sizeof list[0])));
    a.raw(list.data(), list.size() * sizeof list[0]);
}

template <class Archive>
void pass(Archive& a, lie::State& x)
{
    static_assert(sizeof(lie::Motion) == 24 * sizeof(double), "a motion is 24 numbers and nothing else");
    pass(a, x.t);
    pass_list(a, x.body);
    pass_list(a, x.alpha);
    pass_list(a, x.lambda);
    pass_list(a, x.discrete_state);
    pass_list(a, x.internal_state);
    pass_list(a, x.history);
}

constexpr size_t bytes_of_event = 2 * sizeof(int) + 2 * sizeof(double);

template <class Archive>
void pass(Archive& a, contact::ContactEvent& e)
{
    auto kind = static_cast<int>(e.type);
    pass(a, kind);
    e.type = static_cast<contact::ContactEvent::Type>(kind);
    pass(a, e.t);
    pass(a, e.contact);
    pass(a, e.speed);
}

/// The content, in its order, in both directions
template <class Archive>
void pass(Archive& a, Checkpoint& c)
{
    pass_list(a, c.settings);
    pass(a, c.node);
    pass(a, c.number);
    pass(a, c.iterations);
    pass(a, c.pivots);
    for (long* n : {&c.statistics.steps, &c.statistics.iterations, &c.statistics.factorizations,
                    &c.statistics.refactorizations, &c.invariants.nodes, &c.invariants.rows,
                    &c.last_step.factorizations, &c.last_step.wall_ns})
        pass(a, *n);
    for (double* v : {&c.invariants.energy_start, &c.invariants.energy_end, &c.invariants.energy_drift,
                      &c.invariants.constraint_norm, &c.invariants.orthogonality, &c.wall_seconds,
                      &c.last_step.correction})
        pass(a, *v);
    pass_list(a, c.invariants.contact);
    c.contacts.events.resize(a.count(c.contacts.events.size(), bytes_of_event));
    for (contact::ContactEvent& e : c.contacts.events) pass(a, e);
    pass_list(a, c.contacts.closed);
    pass(a, c.trajectory_bytes);
    pass(a, c.steps_bytes);
}

}  // namespace

std::string to_bytes(const Checkpoint& checkpoint)
{
    Pack a;
    std::uint64_t version = format, length = 0;
    a.raw(magic, sizeof magic);
    pass(a, version);
    pass(a, length);
    Checkpoint copy =
        checkpoint;  // pass() serves both directions, so it wants something that it could write to
    pass(a, copy);
    length = a.bytes.size() + tail;
    std::memcpy(a.bytes.data() + sizeof magic + sizeof version, &length, sizeof length);
    std::uint32_t crc = crc32(a.bytes.data(), a.bytes.size());
    pass(a, crc);
    return std::move(a.bytes);
}

Checkpoint from_bytes(const std::string& bytes, const std::string& file)
{
    const auto damaged = [&](const std::string& how) {
        return IoError(file + ": the checkpoint is damaged: " + how);
    };
    if (bytes.size() < head + tail || std::memcmp(bytes.data(), magic, sizeof magic) != 0)
        throw damaged("it does not begin as one");
    Unpack a{bytes.data() + sizeof magic, bytes.data() + bytes.size(), file};
    std::uint64_t version = 0, length = 0;
    pass(a, version);
    pass(a, length);
    std::uint32_t crc = 0;
    std::memcpy(&crc, bytes.data() + bytes.size() - tail, sizeof crc);
    if (length != bytes.size())
        throw damaged(fmt::format("it should have {} bytes, got {}", length, bytes.size()));
    if (crc != crc32(bytes.data(), bytes.size() - tail)) throw damaged("its checksum is wrong");
    if (version != format)
        throw IoError(fmt::format("{}: the checkpoint has format {}; this program reads format {}", file,
                                  version, format));

    a.end -= tail;
    Checkpoint c;
    pass(a, c);
    if (a.at != a.end) throw damaged("it is too long");
    return c;
}

namespace {

struct Names {
    explicit Names(const std::string& directory)
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
    const Names names(directory);
    write_file(names.next, to_bytes(checkpoint));
    if (exists(names.last)) rename_file(names.last, names.before);
    rename_file(names.next, names.last);
}

std::optional<Checkpoint> load(const std::string& directory)
{
    const Names names(directory);
    if (!exists(names.last) && !exists(names.before)) return {};
    try {
        return from_bytes(read_file(names.last, largest_file), names.last);
    } catch (const IoError& error) {
        if (!exists(names.before)) throw;
        warning(std::string(error.what()) + "; going on from the one before");
    }
    return from_bytes(read_file(names.before, largest_file), names.before);
}

void remove_checkpoints(const std::string& directory)
{
    const Names names(directory);
    for (const std::string& file : {names.last, names.before, names.next}) std::remove(file.c_str());
}

std::uint64_t hash(const std::string& text)
{
    std::uint64_t h = 0xcbf29ce484222325u;
    for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    return h;
}

}  // namespace hilda::studies
