// SPDX-License-Identifier: GPL-3.0-or-later
// Serialisation of a world between two steps. Writing a checkpoint invalidates the neighbour list, so that
// the world that continues and a world that is restored build it at the same step and give bitwise identical
// results from then on.
//
// Layout, little endian: magic, format, length in bytes; run id, scalars, lists (length and elements);
// checksum.
#include "granular/world/world.hpp"
#include "io/checksum.hpp"
#include "io/error.hpp"

#include <bit>
#include <cstring>

namespace hilda::granular {

namespace {

static_assert(std::endian::native == std::endian::little, "checkpoints are little endian");

constexpr char magic[8] = {'H', 'I', 'L', 'D', 'A', 'G', 'R', 'N'};
constexpr std::uint64_t format = 5;
constexpr std::size_t header_size = sizeof magic + 2 * sizeof(std::uint64_t),
                      trailer_size = sizeof(std::uint64_t);

struct Writer {
    std::string bytes;
    template <class T>
    void operator()(const T& value)
    {
        static_assert(std::is_trivially_copyable_v<T>);
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    template <class T>
    void list(const T* values, std::size_t n)
    {
        (*this)(static_cast<std::uint64_t>(n));
        if (n > 0) bytes.append(reinterpret_cast<const char*>(values), n * sizeof(T));
    }
};

struct Reader {
    const char *at, *end;
    const std::string& file;

    void raw(void* to, std::size_t n)
    {
        if (static_cast<std::size_t>(end - at) < n)
            throw io::IoError(file + ": the checkpoint is damaged: it is truncated");
        if (n > 0) std::memcpy(to, at, n);
        at += n;
    }
    template <class T>
    T one()
    {
        T value;
        raw(&value, sizeof value);
        return value;
    }
    template <class Array>
    std::size_t list(Array& to)
    {
        using T = std::remove_reference_t<decltype(*to.data())>;
        const auto n = one<std::uint64_t>();
        if (n > static_cast<std::size_t>(end - at) / sizeof(T))
            throw io::IoError(file + ": the checkpoint is damaged: a list is longer than the file");
        to.resize(n);
        raw(static_cast<void*>(to.data()), n * sizeof(T));
        return n;
    }
};

}  // namespace

std::string World::to_bytes(const std::string& run_id)
{
    insert_pending();
    Writer a;
    a.bytes.append(magic, sizeof magic);
    a(format), a(std::uint64_t{0});
    a.list(run_id.data(), run_id.size());
    a(step_count), a(rebuild_count), a(max_speed), a(domain);
    a.list(boundaries.data(), boundaries.size());
    a.list(forces.data(), forces.size());
    const Arrays<par::Cpu>& all = engine->arrays();
    const Particles<par::Cpu>& particle = all.particle;
    const Pairs<par::Cpu>& pairs = all.pairs;
    const auto array = [&](const auto& values, std::size_t n) { a.list(values.data(), n); };
    const std::uint32_t n = particle.count;
    array(particle.position, n), array(particle.velocity, n), array(particle.omega, n),
        array(particle.compensation, n), array(particle.species, n);
    array(particle.id, n), array(particle.acc, particle.acc.size()),
        array(particle.alpha, particle.alpha.size());
    array(particle.orientation, particle.orientation.size());
    array(particle.orientation_compensation, particle.orientation_compensation.size());
    // Only pairs in contact have a history. The others are found when the neighbour list is rebuilt.
    std::vector<std::uint32_t> i, j;
    std::vector<Float4> history, rotation_history;
    for (std::uint32_t k = 0; k < pairs.count; ++k) {
        if (pairs.in_contact.data()[k] == 0) continue;
        i.push_back(pairs.i.data()[k]), j.push_back(pairs.j.data()[k]);
        history.push_back(pairs.history.data()[k]);
        if (pairs.rotation_history.size() > 0) rotation_history.push_back(pairs.rotation_history.data()[k]);
    }
    array(i, i.size()), array(j, j.size()), array(history, history.size()),
        array(rotation_history, rotation_history.size());
    const std::uint64_t length = a.bytes.size() + trailer_size;
    std::memcpy(a.bytes.data() + sizeof magic + sizeof format, &length, sizeof length);
    a(io::checksum(a.bytes.data(), a.bytes.size()));
    invalidate_neighbours();
    return std::move(a.bytes);
}

void World::from_bytes(const std::string& bytes, const std::string& run_id, const std::string& file)
{
    const auto damaged = [&](const std::string& how) {
        return io::IoError(file + ": the checkpoint is damaged: " + how);
    };
    if (bytes.size() < header_size + trailer_size || std::memcmp(bytes.data(), magic, sizeof magic) != 0)
        throw damaged("the header is missing");
    Reader a{bytes.data() + sizeof magic, bytes.data() + bytes.size() - trailer_size, file};
    std::uint64_t sum = 0;
    std::memcpy(&sum, a.end, sizeof sum);
    const auto version = a.one<std::uint64_t>(), length = a.one<std::uint64_t>();
    if (length != bytes.size())
        throw damaged("it must have " + std::to_string(length) + " bytes, got " +
                      std::to_string(bytes.size()));
    if (sum != io::checksum(bytes.data(), bytes.size() - trailer_size))
        throw damaged("the checksum is wrong");
    if (version != format)
        throw io::IoError(file + ": the checkpoint has format " + std::to_string(version) +
                          "; this program reads format " + std::to_string(format));
    std::string run;
    a.list(run);
    if (run != run_id) throw io::IoError(file + ": the checkpoint belongs to another run");
    insert_pending();
    step_count = a.one<long>(), rebuild_count = a.one<long>();
    max_speed = a.one<float>(), domain = a.one<Domain>();
    a.list(boundaries), a.list(forces);
    forces_changed = true;
    Arrays<par::Cpu>& all = engine->arrays();
    Particles<par::Cpu>& particle = all.particle;
    Pairs<par::Cpu>& pairs = all.pairs;
    const auto n = a.list(particle.position);
    a.list(particle.velocity), a.list(particle.omega), a.list(particle.compensation),
        a.list(particle.species), a.list(particle.id);
    a.list(particle.acc), a.list(particle.alpha);
    a.list(particle.orientation);
    if (a.list(particle.orientation_compensation) != (options.orientation ? n : 0))
        throw io::IoError(file + ": the checkpoint " + (options.orientation ? "has no" : "has") +
                          " orientations, but /orientation of this case is " +
                          (options.orientation ? "true" : "false"));
    particle.count = static_cast<std::uint32_t>(n);
    inserted_count = n;
    pairs.count = static_cast<std::uint32_t>(a.list(pairs.i));
    a.list(pairs.j), a.list(pairs.history);
    const bool rotation_laws = a.list(pairs.rotation_history) > 0;
    if (a.at != a.end) throw damaged("it has trailing bytes");
    pairs.in_contact.resize(pairs.count), pairs.load.resize(pairs.count);
    par::fill(par::Cpu(), pairs.in_contact.data(), pairs.count, std::uint8_t{1});
    par::fill(par::Cpu(), pairs.load.data(), pairs.count, Load{});
    if (rotation_laws) {
        pairs.torque.resize(pairs.count);
        par::fill(par::Cpu(), pairs.torque.data(), pairs.count, Float4{});
    }
    engine->arrays_modified();
    time = static_cast<double>(step_count) * options.h;
    invalidate_neighbours();
}

}  // namespace hilda::granular
