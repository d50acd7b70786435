// SPDX-License-Identifier: GPL-3.0-or-later
/// How the threads of OpenMP wait for each other.

#pragma once

namespace hilda::granular {

/// Lets threads that wait for others sleep after about 30 us, if the command line has --threads.
///
/// By default the OpenMP runtime of GCC lets them spin for milliseconds. On a machine whose cores are busy
/// the waiting threads then take the time of the working ones. The runtime reads its settings before main(),
/// so that the program starts itself again with GOMP_SPINCOUNT; process id, files and arguments remain.
/// Nothing is done if GOMP_SPINCOUNT or OMP_WAIT_POLICY is set already, or if the program cannot be started
/// again.
void let_threads_sleep(int argc, char** argv);

}  // namespace hilda::granular
