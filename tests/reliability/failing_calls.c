// Library to preload (LD_PRELOAD): counts the calls that write files, and makes one of them fail.
//
//   FAILING_CALLS_LOG=FILE         writes a line for each call: number, name, path or descriptor
//   FAILING_CALLS_AT=N             the N-th call fails
//   FAILING_CALLS_WITH=ERROR       errno of the failing call; 0: a write that writes half of its bytes
//   FAILING_CALLS_FROM=1           later calls that can fail in this way fail too (a disk that stays full)
//
// Not counted: writes to standard streams, pipes and sockets, and calls of child processes. stdio writes through calls
// inside the C library, which cannot be intercepted; its functions are counted instead.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

static long calls = 0, failing_at = 0;
static int error_given = 0, stays = 0, log_file = -1, is_on = 0;
static char written[4096];
static pthread_mutex_t counting = PTHREAD_MUTEX_INITIALIZER;

#define REAL(name, type, ...)                                             \
    static type (*real_##name)(__VA_ARGS__) = NULL;                       \
    if (!real_##name) *(void**)&real_##name = dlsym(RTLD_NEXT, #name)

static long raw_write(int file, const char* text, size_t size) {
    REAL(write, ssize_t, int, const void*, size_t);
    return real_write(file, text, size);
}

__attribute__((constructor)) static void begin(void) {
    const char *at = getenv("FAILING_CALLS_AT"), *with = getenv("FAILING_CALLS_WITH");
    const char* path = getenv("FAILING_CALLS_LOG");
    REAL(open, int, const char*, int, ...);
    if (path) log_file = real_open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (at) failing_at = atol(at);
    if (with) error_given = atoi(with);
    stays = getenv("FAILING_CALLS_FROM") != NULL;
    is_on = 1;
    unsetenv("LD_PRELOAD");
}

// Counts a call. Returns whether it must fail, and then sets errno.
static int fails(const char* name, const char* what) {
    static const char* failing_name = NULL;
    if (!is_on) return 0;
    pthread_mutex_lock(&counting);
    ++calls;
    if (log_file >= 0) {
        char line[512];
        const int length = snprintf(line, sizeof line, "%ld\t%s\t%s\n", calls, name, what);
        raw_write(log_file, line, (size_t)(length < (int)sizeof line ? length : (int)sizeof line - 1));
    }
    int failing = calls == failing_at;
    if (failing) failing_name = name;
    // a full disk refuses new files and longer files; closing and removing files still works
    if (stays && failing_at && calls > failing_at)
        failing = !strcmp(name, "write") || !strcmp(name, "open") || !strcmp(name, "mkdir") ||
                  (failing_name && !strcmp(name, failing_name));
    pthread_mutex_unlock(&counting);
    if (failing) errno = error_given;
    return failing;
}

static int fails_of(const char* name, int file) {
    char what[32];
    snprintf(what, sizeof what, "%d", file);
    return fails(name, what);
}

static int is_counted(int file) { return file > 2 && file < (int)sizeof written && written[file]; }

static int opened(int file, int flags) {
    struct stat properties;
    if (file >= 0 && file < (int)sizeof written)
        written[file] = (flags & O_ACCMODE) != O_RDONLY && fstat(file, &properties) == 0 && S_ISREG(properties.st_mode);
    return file;
}

static int is_writing(const char* path, int flags) {
    return ((flags & O_ACCMODE) != O_RDONLY || (flags & O_CREAT)) && strncmp(path, "/dev/", 5) != 0;
}

#define MODE_OF(flags)                                  \
    mode_t mode = 0;                                    \
    if ((flags) & (O_CREAT | O_TMPFILE)) {              \
        va_list rest;                                   \
        va_start(rest, flags);                          \
        mode = va_arg(rest, mode_t);                    \
        va_end(rest);                                   \
    }

#define OPEN(name)                                                            \
    int name(const char* path, int flags, ...) {                              \
        MODE_OF(flags)                                                        \
        REAL(name, int, const char*, int, ...);                               \
        if (is_writing(path, flags) && fails("open", path)) return -1;        \
        return opened(real_##name(path, flags, mode), flags);                 \
    }
OPEN(open)
OPEN(open64)

#define OPENAT(name)                                                          \
    int name(int directory, const char* path, int flags, ...) {               \
        MODE_OF(flags)                                                        \
        REAL(name, int, int, const char*, int, ...);                          \
        if (is_writing(path, flags) && fails("open", path)) return -1;        \
        return opened(real_##name(directory, path, flags, mode), flags);      \
    }
OPENAT(openat)
OPENAT(openat64)

#define STREAM(name)                                                                                            \
    FILE* name(const char* path, const char* mode) {                                                            \
        REAL(name, FILE*, const char*, const char*);                                                            \
        const int writes = strpbrk(mode, "wa+") != NULL;                                                        \
        if (writes && fails("open", path)) return NULL;                                                         \
        FILE* stream = real_##name(path, mode);                                                                 \
        if (stream) opened(fileno(stream), writes ? O_WRONLY : O_RDONLY);                                       \
        return stream;                                                                                          \
    }
STREAM(fopen)
STREAM(fopen64)

#define TEMPORARY(name)                                   \
    FILE* name(void) {                                    \
        REAL(name, FILE*, void);                          \
        return fails("tmpfile", "") ? NULL : real_##name(); \
    }
TEMPORARY(tmpfile)
TEMPORARY(tmpfile64)

size_t fwrite(const void* text, size_t size, size_t count, FILE* stream) {
    REAL(fwrite, size_t, const void*, size_t, size_t, FILE*);
    if (fileno(stream) > 2 && size * count > 0 && fails_of("fwrite", fileno(stream))) return 0;
    return real_fwrite(text, size, count, stream);
}

int fflush(FILE* stream) {
    REAL(fflush, int, FILE*);
    if (stream && fileno(stream) > 2 && fails_of("fflush", fileno(stream))) return EOF;
    return real_fflush(stream);
}

ssize_t write(int file, const void* text, size_t size) {
    REAL(write, ssize_t, int, const void*, size_t);
    if (is_counted(file) && size > 0 && fails_of("write", file)) {
        if (error_given != 0) return -1;
        return real_write(file, text, size > 1 ? size / 2 : 1);
    }
    return real_write(file, text, size);
}

ssize_t writev(int file, const struct iovec* parts, int count) {
    REAL(writev, ssize_t, int, const struct iovec*, int);
    if (is_counted(file) && fails_of("write", file)) {
        if (error_given != 0) return -1;
        return count > 0 ? raw_write(file, parts->iov_base, parts->iov_len > 1 ? parts->iov_len / 2 : 1) : 0;
    }
    return real_writev(file, parts, count);
}

#define POSITIONED(name, offset_type)                                          \
    ssize_t name(int file, const void* text, size_t size, offset_type at) {    \
        REAL(name, ssize_t, int, const void*, size_t, offset_type);            \
        if (is_counted(file) && size > 0 && fails_of("write", file)) {         \
            if (error_given != 0) return -1;                                   \
            return real_##name(file, text, size > 1 ? size / 2 : 1, at);       \
        }                                                                      \
        return real_##name(file, text, size, at);                              \
    }
POSITIONED(pwrite, off_t)
POSITIONED(pwrite64, off64_t)

// A failed close() still closes the descriptor, as on Linux.
int close(int file) {
    REAL(close, int, int);
    const int failing = is_counted(file) && fails_of("close", file);
    if (file >= 0 && file < (int)sizeof written) written[file] = 0;
    const int result = real_close(file);
    if (!failing) return result;
    errno = error_given;
    return -1;
}

#define OF_FILE(name)                                                        \
    int name(int file) {                                                     \
        REAL(name, int, int);                                                \
        return fails_of("fsync", file) ? -1 : real_##name(file);             \
    }
OF_FILE(fsync)
OF_FILE(fdatasync)

int syncfs(int folder) {
    REAL(syncfs, int, int);
    return fails_of("syncfs", folder) ? -1 : real_syncfs(folder);
}

int fchmod(int file, mode_t mode) {
    REAL(fchmod, int, int, mode_t);
    return fails_of("fchmod", file) ? -1 : real_fchmod(file, mode);
}

int flock(int file, int operation) {
    REAL(flock, int, int, int);
    return fails_of("flock", file) ? -1 : real_flock(file, operation);
}

#define TRUNCATING(name, offset_type)                                        \
    int name(int file, offset_type size) {                                   \
        REAL(name, int, int, offset_type);                                   \
        return fails_of("ftruncate", file) ? -1 : real_##name(file, size);   \
    }
TRUNCATING(ftruncate, off_t)
TRUNCATING(ftruncate64, off64_t)

int rename(const char* from, const char* to) {
    REAL(rename, int, const char*, const char*);
    return fails("rename", to) ? -1 : real_rename(from, to);
}

int renameat(int from_directory, const char* from, int to_directory, const char* to) {
    REAL(renameat, int, int, const char*, int, const char*);
    return fails("rename", to) ? -1 : real_renameat(from_directory, from, to_directory, to);
}

int renameat2(int from_directory, const char* from, int to_directory, const char* to, unsigned flags) {
    REAL(renameat2, int, int, const char*, int, const char*, unsigned);
    return fails("rename", to) ? -1 : real_renameat2(from_directory, from, to_directory, to, flags);
}

int link(const char* from, const char* to) {
    REAL(link, int, const char*, const char*);
    return fails("link", to) ? -1 : real_link(from, to);
}

int mkdir(const char* path, mode_t mode) {
    REAL(mkdir, int, const char*, mode_t);
    return fails("mkdir", path) ? -1 : real_mkdir(path, mode);
}

int unlink(const char* path) {
    REAL(unlink, int, const char*);
    return fails("unlink", path) ? -1 : real_unlink(path);
}

int unlinkat(int directory, const char* path, int flags) {
    REAL(unlinkat, int, int, const char*, int);
    return fails("unlink", path) ? -1 : real_unlinkat(directory, path, flags);
}

int remove(const char* path) {
    REAL(remove, int, const char*);
    return fails("unlink", path) ? -1 : real_remove(path);
}
