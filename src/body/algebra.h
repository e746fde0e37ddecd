// Vectors, quaternions and 3x3 matrices over any scalar.
//
// Main types: Vector3, Quaternion (Hamilton's convention) and Matrix3 (row-major). Only +, -, * and, in inverse(), /
// are used, so that the scalar S may be float, double, long double, a 128-bit float, a multiprecision number, a
// traced Taylor coefficient, a dual number or a ball. An operation between two scalar types A and B (say a binary64
// parameter and a dual number) returns the type of their product. Functions that need a square root or a comparison
// are defined beside the scalar type.
#pragma once

#include <array>
#include <cstddef>

namespace polhode {

/// The scalar type of the product of an A and a B.
template <class A, class B>
using Product = decltype(A() * B());

/// Three components along the axes of one frame. A suffix _B or _W of a variable's name denotes the frame.
template <class S>
struct Vector3 {
    std::array<S, 3> component{};  ///< x, y, z

    /// The zero vector.
    Vector3() : component{S(0), S(0), S(0)} {}
    /// The vector (x, y, z).
    Vector3(S x, S y, S z) : component{x, y, z} {}
    /// The i-th component, i = 0, 1, 2.
    S& operator[](std::size_t i) { return component[i]; }
    /// The i-th component, i = 0, 1, 2.
    const S& operator[](std::size_t i) const { return component[i]; }
    /// Whether all components are equal.
    bool operator==(const Vector3&) const = default;
};

/// w + x i + y j + z k with Hamilton's product. A unit quaternion q maps body vectors to world vectors: v_W = q v_B
/// q*.
template <class S>
struct Quaternion {
    S w = S(1);  ///< scalar part; the default quaternion is the identity
    S x = S(0);  ///< vector part, first axis
    S y = S(0);  ///< vector part, second axis
    S z = S(0);  ///< vector part, third axis

    /// Whether all four numbers are equal. q and -q represent the same rotation but compare unequal.
    bool operator==(const Quaternion&) const = default;
};

/// A 3x3 matrix, row by row: M[row][column].
template <class S>
struct Matrix3 {
    std::array<Vector3<S>, 3> row{};  ///< zero by default

    /// The i-th row, i = 0, 1, 2.
    Vector3<S>& operator[](std::size_t i) { return row[i]; }
    /// The i-th row, i = 0, 1, 2.
    const Vector3<S>& operator[](std::size_t i) const { return row[i]; }
    /// Whether all entries are equal.
    bool operator==(const Matrix3&) const = default;
};

/// Componentwise sum.
template <class A, class B>
Vector3<Product<A, B>> operator+(const Vector3<A>& a, const Vector3<B>& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

/// Componentwise difference.
template <class A, class B>
Vector3<Product<A, B>> operator-(const Vector3<A>& a, const Vector3<B>& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

/// The negated vector.
template <class S>
Vector3<S> operator-(const Vector3<S>& a) {
    return {-a[0], -a[1], -a[2]};
}

/// The product of a scalar and a vector.
template <class A, class B>
Vector3<Product<A, B>> operator*(const A& a, const Vector3<B>& v) {
    return {a * v[0], a * v[1], a * v[2]};
}

/// The dot product a . b.
template <class A, class B>
Product<A, B> dot(const Vector3<A>& a, const Vector3<B>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// The cross product a x b.
template <class A, class B>
Vector3<Product<A, B>> cross(const Vector3<A>& a, const Vector3<B>& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The matrix-vector product M v.
template <class A, class B>
Vector3<Product<A, B>> operator*(const Matrix3<A>& m, const Vector3<B>& v) {
    return {dot(m[0], v), dot(m[1], v), dot(m[2], v)};
}

/// The transpose.
template <class S>
Matrix3<S> transposed(const Matrix3<S>& m) {
    Matrix3<S> t;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) t[i][j] = m[j][i];
    return t;
}

/// The matrix product a b.
template <class A, class B>
Matrix3<Product<A, B>> operator*(const Matrix3<A>& a, const Matrix3<B>& b) {
    Matrix3<Product<A, B>> c;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) c[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
    return c;
}

/// Entrywise sum.
template <class A, class B>
Matrix3<Product<A, B>> operator+(const Matrix3<A>& a, const Matrix3<B>& b) {
    return {{a[0] + b[0], a[1] + b[1], a[2] + b[2]}};
}

/// The diagonal matrix with the components of `d`.
template <class S>
Matrix3<S> diagonal(const Vector3<S>& d) {
    Matrix3<S> m;
    for (int i = 0; i < 3; ++i) m[i][i] = d[i];
    return m;
}

/// The inverse by cofactors. Divides by the determinant, which must not be zero.
template <class S>
Matrix3<S> inverse(const Matrix3<S>& m) {
    const Vector3<S> c0 = cross(m[1], m[2]), c1 = cross(m[2], m[0]), c2 = cross(m[0], m[1]);
    const S determinant = dot(m[0], c0);
    Matrix3<S> result;
    for (int i = 0; i < 3; ++i) {
        result[i][0] = c0[i] / determinant;
        result[i][1] = c1[i] / determinant;
        result[i][2] = c2[i] / determinant;
    }
    return result;
}

/// q* = w - x i - y j - z k. For a unit quaternion this is the inverse rotation.
template <class S>
Quaternion<S> conjugate(const Quaternion<S>& q) {
    return {q.w, -q.x, -q.y, -q.z};
}

/// Hamilton's product a b. As a rotation of vectors: first b, then a.
template <class A, class B>
Quaternion<Product<A, B>> operator*(const Quaternion<A>& a, const Quaternion<B>& b) {
    return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

/// |q|^2 = w^2 + x^2 + y^2 + z^2.
template <class S>
S squared_norm(const Quaternion<S>& q) {
    return q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
}

/// The vector part (x, y, z).
template <class S>
Vector3<S> vector_part(const Quaternion<S>& q) {
    return {q.x, q.y, q.z};
}

/// |q|^2 R(q), a quadratic form in q. For a unit quaternion this is the rotation matrix from body to world axes.
template <class S>
Matrix3<S> rotation_matrix(const Quaternion<S>& q) {
    const S ww = q.w * q.w, xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z;
    const S xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z, wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
    Matrix3<S> m;
    m[0] = {ww + xx - yy - zz, (xy - wz) + (xy - wz), (xz + wy) + (xz + wy)};
    m[1] = {(xy + wz) + (xy + wz), ww - xx + yy - zz, (yz - wx) + (yz - wx)};
    m[2] = {(xz - wy) + (xz - wy), (yz + wx) + (yz + wx), ww - xx - yy + zz};
    return m;
}

/// |q|^2 R(q)^T e_b: row b of rotation_matrix(q). For a unit quaternion this is the world axis b in body axes.
template <class S>
Vector3<S> world_axis(const Quaternion<S>& q, int b) {
    const auto twice = [](const S& s) { return s + s; };
    if (b == 0)
        return {q.w * q.w + q.x * q.x - q.y * q.y - q.z * q.z, twice(q.x * q.y - q.w * q.z),
                twice(q.x * q.z + q.w * q.y)};
    if (b == 1)
        return {twice(q.x * q.y + q.w * q.z), q.w * q.w - q.x * q.x + q.y * q.y - q.z * q.z,
                twice(q.y * q.z - q.w * q.x)};
    return {twice(q.x * q.z - q.w * q.y), twice(q.y * q.z + q.w * q.x), q.w * q.w - q.x * q.x - q.y * q.y + q.z * q.z};
}

/// |q|^2 R(q) v. For a unit quaternion this is the body vector v in world axes.
template <class S, class V>
Vector3<Product<S, V>> rotate(const Quaternion<S>& q, const Vector3<V>& v) {
    // (w^2 - u.u) v + 2 (u.v) u + 2 w u x v
    const Vector3<S> u = vector_part(q);
    const Product<S, V> twice_projection = dot(u, v) + dot(u, v);
    const S scale = q.w * q.w - dot(u, u), twice_w = q.w + q.w;
    return scale * v + (twice_projection * u + twice_w * cross(u, v));
}

/// |q|^2 R(q)^T v. For a unit quaternion this is the world vector v in body axes.
template <class S, class V>
Vector3<Product<S, V>> rotate_back(const Quaternion<S>& q, const Vector3<V>& v) {
    return rotate(conjugate(q), v);
}

/// Converts each component to the scalar To by To(from).
template <class To, class From>
Vector3<To> cast(const Vector3<From>& v) {
    return {To(v[0]), To(v[1]), To(v[2])};
}
/// Converts each number to the scalar To by To(from).
template <class To, class From>
Quaternion<To> cast(const Quaternion<From>& q) {
    return {To(q.w), To(q.x), To(q.y), To(q.z)};
}
/// Converts each entry to the scalar To by To(from).
template <class To, class From>
Matrix3<To> cast(const Matrix3<From>& m) {
    return {{cast<To>(m[0]), cast<To>(m[1]), cast<To>(m[2])}};
}

}  // namespace polhode
