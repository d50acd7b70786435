// SPDX-License-Identifier: GPL-3.0-or-later
/// The arrays of a world and the loops over them, where they live: on the CPU or on a GPU.

#pragma once

#include "granular/core/integrator.hpp"
#include "granular/core/neighbours.hpp"

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace hilda::granular {

/// No device of this kind, or none with this number, or it has failed. what() says which and why.
class DeviceError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

struct Device {
    enum Kind { cpu, cuda } kind = cpu;
    int number = 0;
};

template <class Backend>
struct Arrays {
    Particles<Backend> particle;
    Pairs<Backend> pairs;
};

struct Wrench {
    Vec3 F = {0, 0, 0}, T = {0, 0, 0};  ///< [N, N m], about Boundary::r
};

/// The steps of a world, each a loop over all of its particles or pairs. Functors are the same on every device, and so
/// are results, to the bit.
class Engine {
public:
    virtual ~Engine() = default;

    /// The arrays as the host sees them, as of now
    virtual Arrays<par::Cpu>& arrays() = 0;
    /// The caller has written into arrays().
    virtual void written() = 0;

    /// law_of: materials × materials
    virtual void set_laws(const std::vector<PairLaw>& laws, const std::vector<std::uint8_t>& law_of,
                          std::uint32_t materials) = 0;
    virtual void set_boundaries(const std::vector<Boundary>& boundaries) = 0;
    /// From outside, by id [N]; none where the list is empty
    virtual void set_forces(const std::vector<Four>& forces) = 0;

    /// See Neighbours::find.
    virtual void find_neighbours(const Scene& scene) = 0;
    /// See find_loads.
    virtual void find_loads(const Scene& scene, float h) = 0;
    /// See advance.
    virtual float advance(const StepOf& step) = 0;
    /// The longest way of a particle since neighbours were looked for [units]
    virtual float longest_way() = 0;
    /// What the last loads are on boundaries that are not held, by their numbers; zero for the others
    virtual const std::vector<Wrench>& on_free_boundaries(const Scene& scene) = 0;

    /// Until all that was begun is done: for those who read a clock
    virtual void wait() = 0;
    /// Bytes per second of a copy within its memory, counting what is read and what is written
    virtual double copy_rate() = 0;

    virtual std::size_t bytes() const = 0;
};

/// DeviceError where there is no such device, or this build knows no GPU. A process uses one GPU, from one thread.
std::unique_ptr<Engine> make_engine(Device device);
std::unique_ptr<Engine> make_gpu_engine(int number);
/// Names of the GPUs that could be used; empty where there are none, and then `why_not` says why.
std::vector<std::string> gpus(std::string& why_not);
/// What is free on a GPU [bytes]. DeviceError
std::size_t gpu_memory(int number);

}  // namespace hilda::granular
