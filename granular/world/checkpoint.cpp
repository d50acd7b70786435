// SPDX-License-Identifier: GPL-3.0-or-later
// A world written down between two steps. A world that goes on looks for its neighbours anew at the same step, so that
// it and one that was loaded have the same bits from then on.
#include "granular/files.hpp"
#include "granular/world/world.hpp"

#include <bit>
#include <cstring>

namespace hilda::granular {

namespace {

static_assert(std::endian::native == std::endian::little, "checkpoints are little endian");

constexpr char magic[8] = {'H', 'I', 'L', 'D', 'A', 'G', 'R', 'N'};
constexpr std::uint64_t format = 5;
constexpr std::size_t head = sizeof magic + 2 * sizeof(std::uint64_t), tail = sizeof(std::uint64_t);

struct Pack {
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

struct Unpack {
    const char *at, *end;
    const std::string& file;

    void raw(void* to, std::size_t n)
    {
        if (static_cast<std::size_t>(end - at) < n)
            throw FileError(file + ": the checkpoint is damaged: it ends too early");
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
            throw FileError(file + ": the checkpoint is damaged: a list is too long");
        to.resize(n);
        raw(static_cast<void*>(to.data()), n * sizeof(T));
        return n;
    }
};

}  // namespace

std::string World::to_bytes(const std::string& of_run)
{
    insert_pending();
    Pack a;
    a.bytes.append(magic, sizeof magic);
    a(format), a(std::uint64_t{0});
    a.list(of_run.data(), of_run.size());
    a(number), a(found), a(fastest), a(scene);
    a.list(boundaries.data(), boundaries.size());
    a.list(forces.data(), forces.size());
    const Arrays<par::Cpu>& all = engine->arrays();
    const Particles<par::Cpu>& particle = all.particle;
    const Pairs<par::Cpu>& pairs = all.pairs;
    const auto array = [&](const auto& values, std::size_t n) { a.list(values.data(), n); };
    const std::uint32_t n = particle.count;
    array(particle.position, n), array(particle.velocity, n), array(particle.omega, n),
        array(particle.rest, n), array(particle.kind, n);
    array(particle.id, n), array(particle.acc, particle.acc.size()),
        array(particle.turn, particle.turn.size());
    array(particle.orientation, particle.orientation.size());
    array(particle.orientation_rest, particle.orientation_rest.size());
    // pairs that touch, and no others: the rest is found again
    std::vector<std::uint32_t> i, j;
    std::vector<Four> history, turning;
    for (std::uint32_t k = 0; k < pairs.count; ++k) {
        if (pairs.touches.data()[k] == 0) continue;
        i.push_back(pairs.i.data()[k]), j.push_back(pairs.j.data()[k]);
        history.push_back(pairs.history.data()[k]);
        if (pairs.turning.size() > 0) turning.push_back(pairs.turning.data()[k]);
    }
    array(i, i.size()), array(j, j.size()), array(history, history.size()), array(turning, turning.size());
    const std::uint64_t length = a.bytes.size() + tail;
    std::memcpy(a.bytes.data() + sizeof magic + sizeof format, &length, sizeof length);
    a(checksum(a.bytes.data(), a.bytes.size()));
    invalidate_neighbours();
    return std::move(a.bytes);
}

void World::from_bytes(const std::string& bytes, const std::string& of_run, const std::string& file)
{
    const auto damaged = [&](const std::string& how) {
        return FileError(file + ": the checkpoint is damaged: " + how);
    };
    if (bytes.size() < head + tail || std::memcmp(bytes.data(), magic, sizeof magic) != 0)
        throw damaged("it does not begin as one");
    Unpack a{bytes.data() + sizeof magic, bytes.data() + bytes.size() - tail, file};
    std::uint64_t sum = 0;
    std::memcpy(&sum, a.end, sizeof sum);
    const auto version = a.one<std::uint64_t>(), length = a.one<std::uint64_t>();
    if (length != bytes.size())
        throw damaged("it should have " + std::to_string(length) + " bytes, got " +
                      std::to_string(bytes.size()));
    if (sum != checksum(bytes.data(), bytes.size() - tail)) throw damaged("its checksum is wrong");
    if (version != format)
        throw FileError(file + ": the checkpoint has format " + std::to_string(version) +
                        "; this program reads format " + std::to_string(format));
    std::string run;
    a.list(run);
    if (run != of_run) throw FileError(file + ": the checkpoint belongs to another run");
    insert_pending();
    number = a.one<long>(), found = a.one<long>();
    fastest = a.one<float>(), scene = a.one<Scene>();
    a.list(boundaries), a.list(forces);
    forces_changed = true;
    Arrays<par::Cpu>& all = engine->arrays();
    Particles<par::Cpu>& particle = all.particle;
    Pairs<par::Cpu>& pairs = all.pairs;
    const auto n = a.list(particle.position);
    a.list(particle.velocity), a.list(particle.omega), a.list(particle.rest), a.list(particle.kind),
        a.list(particle.id);
    a.list(particle.acc), a.list(particle.turn);
    a.list(particle.orientation);
    if (a.list(particle.orientation_rest) != (options.orientation ? n : 0))
        throw FileError(file +
                        ": the checkpoint is of a world that keeps orientations where this one does not, or "
                        "the other way round");
    particle.count = static_cast<std::uint32_t>(n);
    particles_in = n;
    pairs.count = static_cast<std::uint32_t>(a.list(pairs.i));
    a.list(pairs.j), a.list(pairs.history);
    const bool turning = a.list(pairs.turning) > 0;
    if (a.at != a.end) throw damaged("it is too long");
    pairs.touches.resize(pairs.count), pairs.load.resize(pairs.count);
    par::fill(par::Cpu(), pairs.touches.data(), pairs.count, std::uint8_t{1});
    par::fill(par::Cpu(), pairs.load.data(), pairs.count, Load{});
    if (turning) {
        pairs.torque.resize(pairs.count);
        par::fill(par::Cpu(), pairs.torque.data(), pairs.count, Four{});
    }
    engine->written();
    time = static_cast<double>(number) * options.h;
    invalidate_neighbours();
}

}  // namespace hilda::granular
