#!/bin/sh
# A method in another process: reads a scene (JSON) from standard input and prints its trajectory (CSV) at N + 1 times.
#
#   engine.sh N
#
# Supports one motion: a free body that rotates about its z axis and starts with the identity attitude. The angle is
# w t, and q = (cos w t/2, 0, 0, sin w t/2).
scene=$(cat)

# number KEY: prints the last number of the line that contains the key
number() { printf '%s\n' "$scene" | sed -n "s/.*\"$1\".*[ :\[]\(-\{0,1\}[0-9][-+.0-9e]*\)\]*,\{0,1\}\$/\1/p"; }

awk -v samples="$1" -v T="$(number duration)" -v w="$(number angular_velocity)" 'BEGIN {
    print "t,qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz"
    for (k = 0; k <= samples; ++k) {
        t = k * T / samples
        printf "%.17g,%.17g,0,0,%.17g,0,0,%.17g,0,0,0,0,0,0\n", t, cos(w * t / 2), sin(w * t / 2), w
    }
}'
