#pragma once

namespace slamd::cli {

/// Lets Ctrl-C and SIGTERM end what the program does with its results; a second one ends the program.
/// A sleep or a wait in the kernel ends with the signal.
void catch_interrupts();

/// Tells whether one has come.
bool is_interrupted();

}  // namespace slamd::cli
