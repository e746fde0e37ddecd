// Properties of the terminal.
#pragma once

namespace polhode {

/// Whether to write colours to the stream (1 standard output, 2 standard error). False if it is not a terminal, if
/// the environment has NO_COLOR (no-color.org), or if TERM is "dumb" or unset.
bool wants_color(int stream);

/// The number of columns of the terminal on this stream, or `otherwise` if the stream is not a terminal or its width
/// is unknown.
int terminal_width(int stream, int otherwise);

}  // namespace polhode
