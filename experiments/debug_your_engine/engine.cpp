#include <cmath>
#include <cstdio>
int main() {  // the scene t_handle by semi-implicit Euler at 240 Hz, w in body axes
    const double A = 2.2375e-4, B = 3.75e-4, C = 5.7625e-4, h = 1.0 / 240;
    double w = 1, x = 0, y = 0, z = 0, p = 0.01, q = 15, r = 0.02;
    std::puts("t,qw,qx,qy,qz,wx,wy,wz");
    for (int n = 0; n <= 480; ++n) {
        std::printf("%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", n * h, w, x, y, z, p, q, r);
        const double P = p + h * (B - C) / A * q * r, Q = q + h * (C - A) / B * r * p, R = r + h * (A - B) / C * p * q;
        const double a = w - h / 2 * (x * P + y * Q + z * R), b = x + h / 2 * (w * P + y * R - z * Q);
        const double c = y + h / 2 * (w * Q + z * P - x * R), d = z + h / 2 * (w * R + x * Q - y * P);
        const double size = std::sqrt(a * a + b * b + c * c + d * d);
        w = a / size, x = b / size, y = c / size, z = d / size, p = P, q = Q, r = R;
    }
}
