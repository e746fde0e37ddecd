// Owning handles of objects allocated by SUNDIALS.
#pragma once

#include <sundials/sundials_context.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>
#include <sundials/sundials_nonlinearsolver.h>
#include <sundials/sundials_nvector.h>

#include <memory>
#include <new>

namespace polhode {

struct SundialsDeleter {
    void operator()(N_Vector v) const { N_VDestroy(v); }
    void operator()(SUNMatrix m) const { SUNMatDestroy(m); }
    void operator()(SUNLinearSolver s) const { SUNLinSolFree(s); }
    void operator()(SUNNonlinearSolver s) const { SUNNonlinSolFree(s); }
};

template <class Handle>
using SundialsOwner = std::unique_ptr<std::remove_pointer_t<Handle>, SundialsDeleter>;

/// The owner of a new object. Throws std::bad_alloc if it is null.
template <class Handle>
SundialsOwner<Handle> make_owner(Handle handle) {
    if (!handle) throw std::bad_alloc();
    return SundialsOwner<Handle>(handle);
}

/// One context per solver: SUNDIALS shares no data between contexts, so each solver may run in its own thread.
class SundialsContext {
  public:
    SundialsContext() {
        if (SUNContext_Create(nullptr, &context_) != 0) throw std::bad_alloc();
    }
    ~SundialsContext() { SUNContext_Free(&context_); }
    SundialsContext(const SundialsContext&) = delete;
    SundialsContext& operator=(const SundialsContext&) = delete;
    operator SUNContext() const { return context_; }

  private:
    SUNContext context_ = nullptr;
};

}  // namespace polhode
