// The motion between two events, enclosed: what every way to enclose it is given and gives back.
#pragma once

#include <string>
#include <vector>

#include "integrators/truth/ball.h"
#include "integrators/truth/ball_norm.h"
#include "integrators/truth/euler_form.h"

namespace polhode::truth {

/// A piece between two events. The form has entered it; times are exactly these doubles.
struct Piece {
    const EulerForm<Ball>& form;
    double begin, end;
    std::vector<double> sample_times;  ///< increasing, in [begin, end]
    const PiecePlan& plan;
};

/// States as balls; every state of the true motion lies in its balls.
struct Enclosure {
    std::string fault;  ///< why there is none; empty where there is one
    long steps = 0;
    std::vector<std::vector<Ball>> samples;
    std::vector<Ball> end;
};

/// By Taylor series about exact points with a proven defect; errors carried by the logarithmic norm.
Enclosure enclose_by_taylor(const Piece& piece, const std::vector<Ball>& start);

}  // namespace polhode::truth
