// Library to preload (LD_PRELOAD): counts allocations and thread starts from the start of main(), and makes some fail.
//
//   FAILING_MEMORY_COUNTS=FILE   writes the numbers of allocations and threads at the end
//   FAILING_MEMORY_AT=N          the N-th allocation fails
//   FAILING_THREADS_AT=N         the N-th thread start fails with EAGAIN
//   FAILING_MEMORY_FROM=1        all later allocations or thread starts fail too
//
// Counted: allocations of the program and of all its libraries, also the C library. Not counted: child processes.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

extern void* __libc_malloc(size_t);
extern void* __libc_calloc(size_t, size_t);
extern void* __libc_realloc(void*, size_t);
extern void* __libc_memalign(size_t, size_t);

static atomic_long allocations = 0, threads = 0;
static long memory_at = 0, threads_at = 0;
static int stays = 0, is_on = 0;
static const char* counts = NULL;
static int (*real_main)(int, char**, char**) = NULL;

static int is_refused(atomic_long* count, long at) {
    if (!is_on) return 0;
    const long number = atomic_fetch_add(count, 1) + 1;
    return at > 0 && (number == at || (stays && number > at));
}

static int refuses_memory(void) {
    if (!is_refused(&allocations, memory_at)) return 0;
    errno = ENOMEM;
    return 1;
}

void* malloc(size_t size) { return refuses_memory() ? NULL : __libc_malloc(size); }
void* calloc(size_t count, size_t size) { return refuses_memory() ? NULL : __libc_calloc(count, size); }
void* realloc(void* block, size_t size) { return refuses_memory() ? NULL : __libc_realloc(block, size); }
void* memalign(size_t alignment, size_t size) { return refuses_memory() ? NULL : __libc_memalign(alignment, size); }
void* aligned_alloc(size_t alignment, size_t size) {
    return refuses_memory() ? NULL : __libc_memalign(alignment, size);
}
int posix_memalign(void** block, size_t alignment, size_t size) {
    if (refuses_memory()) return ENOMEM;
    *block = __libc_memalign(alignment, size);
    return *block ? 0 : ENOMEM;
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*routine)(void*), void* argument) {
    static int (*real)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*) = NULL;
    if (!real) *(void**)&real = dlsym(RTLD_NEXT, "pthread_create");
    return is_refused(&threads, threads_at) ? EAGAIN : real(thread, attributes, routine, argument);
}

__attribute__((destructor)) static void end(void) {
    is_on = 0;
    if (!counts) return;
    const int file = open(counts, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    dprintf(file, "%ld %ld\n", atomic_load(&allocations), atomic_load(&threads));
    close(file);
}

static int counting_main(int argc, char** argv, char** variables) {
    const char *memory = getenv("FAILING_MEMORY_AT"), *of_threads = getenv("FAILING_THREADS_AT");
    if (memory) memory_at = atol(memory);
    if (of_threads) threads_at = atol(of_threads);
    stays = getenv("FAILING_MEMORY_FROM") != NULL;
    counts = getenv("FAILING_MEMORY_COUNTS");
    unsetenv("LD_PRELOAD");
    is_on = 1;
    return real_main(argc, argv, variables);
}

int __libc_start_main(int (*main_function)(int, char**, char**), int argc, char** argv, void (*init)(void),
                      void (*fini)(void), void (*rtld_fini)(void), void* stack_end) {
    int (*real)(int (*)(int, char**, char**), int, char**, void (*)(void), void (*)(void), void (*)(void), void*) = NULL;
    *(void**)&real = dlsym(RTLD_NEXT, "__libc_start_main");
    real_main = main_function;
    return real(counting_main, argc, argv, init, fini, rtld_fini, stack_end);
}
