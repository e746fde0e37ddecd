// What a terminal shows.
#pragma once

namespace polhode {

/// Whether the stream (1 standard output, 2 standard error) is a terminal that is to have colours: not where the
/// environment has NO_COLOR (no-color.org), and not on one that calls itself dumb.
bool wants_color(int stream);

/// How many columns the terminal has that the stream is, `otherwise` where it is none or does not say.
int terminal_width(int stream, int otherwise);

}  // namespace polhode
