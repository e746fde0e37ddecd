// The options --modes and --events of solve and truth, and the texts that they write.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "integrators/contact/contact_record.h"
#include "integrators/contact/joint_events.h"
#include "integrators/truth/reference.h"
#include "scene/scene.h"

namespace polhode {

/// What the user wants to know about contacts.
struct ContactOptions {
    bool modes = false;  ///< print the modes over time
    std::string events;  ///< file for events; empty: none

    bool any() const { return modes || !events.empty(); }
};

/// Adds --modes and --events to the command.
void add_contact_options(CLI::App& command, ContactOptions& options);

/// Throws UsageError if an option is given and the scene has no planes, or if the file equals one of the others.
void require_contacts(const Scene& scene, const ContactOptions& options, const std::string& output,
                      const std::string& reactions);

/// Writes events to the file and modes to stdout, or to stderr if `to_stdout` is false.
void write_contacts(const Scene& scene, const ContactOptions& options, const DecimalReference& truth, bool to_stdout);

/// Writes the record of a run in binary64 in the same form.
void write_contacts(const Scene& scene, const ContactOptions& options, const contact::Record<double>& record,
                    bool to_stdout);

/// Writes the events of joints with friction or limits.
void write_joint_events(const Scene& scene, const ContactOptions& options,
                        const std::vector<contact::JointEvent<double>>& events);

/// Names of what exerts a reaction: planes, or joints and then loops.
std::vector<std::string> reaction_names(const Scene& scene);

}  // namespace polhode
