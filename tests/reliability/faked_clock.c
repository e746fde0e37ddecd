// Library to preload (LD_PRELOAD): the time of day starts at FAKED_CLOCK seconds after 1970 and goes back one hour at
// each call. Monotonic clocks do not change.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdlib.h>
#include <sys/time.h>
#include <time.h>

static time_t next(void) {
    static time_t now = 0;
    if (now == 0) {
        const char* start = getenv("FAKED_CLOCK");
        now = start ? (time_t)atoll(start) : 1000000000;
    }
    return __atomic_fetch_sub(&now, 3600, __ATOMIC_RELAXED);
}

int clock_gettime(clockid_t clock, struct timespec* time) {
    static int (*real)(clockid_t, struct timespec*) = NULL;
    if (!real) *(void**)&real = dlsym(RTLD_NEXT, "clock_gettime");
    const int result = real(clock, time);
    if (result == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE)) time->tv_sec = next();
    return result;
}

time_t time(time_t* place) {
    const time_t now = next();
    if (place) *place = now;
    return now;
}

int gettimeofday(struct timeval* time, void* zone) {
    (void)zone;
    time->tv_sec = next();
    time->tv_usec = 0;
    return 0;
}
