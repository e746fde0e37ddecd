// Counts reported by IDA, summed over its restarts at events.
#pragma once

#include <ida/ida.h>

namespace polhode {

struct IdaCounts {
    long steps = 0, rejected_steps = 0, newton_failures = 0;

    /// Adds the counts since IDA's last initialisation.
    void add(void* memory) {
        long taken = 0, rejected = 0, failures = 0;
        IDAGetNumSteps(memory, &taken);
        IDAGetNumErrTestFails(memory, &rejected);
        IDAGetNumNonlinSolvConvFails(memory, &failures);
        steps += taken, rejected_steps += rejected, newton_failures += failures;
    }
};

}  // namespace polhode
