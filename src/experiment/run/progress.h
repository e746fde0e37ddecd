// A progress bar for terminals.
#pragma once

#include <string>

namespace polhode {

class Progress {
  public:
    /// Shows nothing if `quiet` is set or standard error is not a terminal.
    Progress(long total, bool quiet);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void advance(const std::string& what);
    void report(const std::string& what);

  private:
    void show(const std::string& what) const;
    long total_, done_ = 0;
    bool shown_;
};

}  // namespace polhode
