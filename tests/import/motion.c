// Integrates MuJoCo's forward dynamics by a Runge-Kutta method of order 4, without MuJoCo's time stepping.
// For MuJoCo 2.2.2 (Debian's libmujoco-dev); motion.mjs is for MuJoCo 3. `compute` calls both and documents the jobs.
#include <math.h>
#include <mujoco/mujoco.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double duration = 0.5;
static int steps_per_half = 2500;  // h = 1e-4 s

// rates of joint coordinates; those of quaternions follow from the angular velocity in the child's axes
static void differentiate(const mjModel* m, mjData* d, double* dq, double* dv) {
    mj_forward(m, d);
    memcpy(dv, d->qacc, sizeof(double) * m->nv);
    for (int j = 0; j < m->njnt; ++j) {
        const int q = m->jnt_qposadr[j], v = m->jnt_dofadr[j], type = m->jnt_type[j];
        if (type == mjJNT_HINGE || type == mjJNT_SLIDE) {
            dq[q] = d->qvel[v];
            continue;
        }
        const int free_joint = type == mjJNT_FREE;
        if (free_joint) memcpy(dq + q, d->qvel + v, 3 * sizeof(double));
        const double *p = d->qpos + q + (free_joint ? 3 : 0), *w = d->qvel + v + (free_joint ? 3 : 0);
        double* r = dq + q + (free_joint ? 3 : 0);
        r[0] = -0.5 * (p[1] * w[0] + p[2] * w[1] + p[3] * w[2]);
        r[1] = 0.5 * (p[0] * w[0] + p[2] * w[2] - p[3] * w[1]);
        r[2] = 0.5 * (p[0] * w[1] + p[3] * w[0] - p[1] * w[2]);
        r[3] = 0.5 * (p[0] * w[2] + p[1] * w[1] - p[2] * w[0]);
    }
}

static void step(const mjModel* m, mjData* d, double h, double* work) {
    const int nq = m->nq, nv = m->nv;
    double *q = work, *v = q + nq, *dq = v + nv, *dv = dq + nq, *sum_q = dv + nv, *sum_v = sum_q + nq;
    static const double node[4] = {0, 0.5, 0.5, 1}, weight[4] = {1. / 6, 1. / 3, 1. / 3, 1. / 6};
    memcpy(q, d->qpos, sizeof(double) * nq), memcpy(v, d->qvel, sizeof(double) * nv);
    memcpy(sum_q, q, sizeof(double) * nq), memcpy(sum_v, v, sizeof(double) * nv);
    for (int s = 0; s < 4; ++s) {
        for (int i = 0; i < nq; ++i) d->qpos[i] = q[i] + (s ? h * node[s] * dq[i] : 0);
        for (int i = 0; i < nv; ++i) d->qvel[i] = v[i] + (s ? h * node[s] * dv[i] : 0);
        differentiate(m, d, dq, dv);
        for (int i = 0; i < nq; ++i) sum_q[i] += h * weight[s] * dq[i];
        for (int i = 0; i < nv; ++i) sum_v[i] += h * weight[s] * dv[i];
    }
    memcpy(d->qpos, sum_q, sizeof(double) * nq), memcpy(d->qvel, sum_v, sizeof(double) * nv);
}

static void print_numbers(const char* name, const double* x, int n) {
    printf("\"%s\":[", name);
    for (int i = 0; i < n; ++i) printf("%s%.17g", i ? "," : "", x[i]);
    printf("]");
}

static void print_moment(const mjModel* m, mjData* d, double t, int first) {
    mj_forward(m, d);
    printf("%s{\"t\":%g,\"bodies\":[", first ? "" : ",", t);
    for (int b = 1; b < m->nbody; ++b) {
        printf("%s{", b > 1 ? "," : "");
        print_numbers("center_of_mass", d->xipos + 3 * b, 3), printf(",");
        print_numbers("origin", d->xpos + 3 * b, 3), printf(",");
        print_numbers("attitude", d->xquat + 4 * b, 4);
        printf("}");
    }
    printf("]}");
}

// removes constructs by name: "armature", "free_damping", "ball_stiffness", "fluid", "tendon"; this version does not
// support gravcomp
static void drop(mjModel* m, const char* what) {
    if (strstr(what, "armature"))
        for (int i = 0; i < m->nv; ++i) m->dof_armature[i] = 0;
    if (strstr(what, "fluid")) m->opt.density = m->opt.viscosity = 0;
    if (strstr(what, "tendon"))
        for (int i = 0; i < m->ntendon; ++i) m->tendon_stiffness[i] = m->tendon_damping[i] = 0;
    for (int j = 0; j < m->njnt; ++j) {
        if (m->jnt_type[j] == mjJNT_FREE && strstr(what, "free_damping"))
            for (int i = 0; i < 6; ++i) m->dof_damping[m->jnt_dofadr[j] + i] = 0;
        if (m->jnt_type[j] == mjJNT_BALL && strstr(what, "ball_stiffness")) m->jnt_stiffness[j] = 0;
    }
}

// "free NAME wx wy wz vx vy vz": w in the body's axes, v of the centre of mass in the world's; "joint NAME rate";
// "ball NAME wx wy wz"; separated by semicolons
static int start(const mjModel* m, mjData* d, char* text) {
    char* rest = NULL;
    for (char* one = strtok_r(text, ";", &rest); one; one = strtok_r(NULL, ";", &rest)) {
        char kind[16], name[128];
        double x[6];
        int count = 0, used = 0;
        if (sscanf(one, "%15s %127s%n", kind, name, &used) != 2) return 0;
        for (char* at = one + used; count < 6 && sscanf(at, "%lf%n", x + count, &used) == 1; at += used) ++count;
        if (strcmp(kind, "free")) {
            const int j = mj_name2id(m, mjOBJ_JOINT, name);
            if (j < 0) return 0;
            memcpy(d->qvel + m->jnt_dofadr[j], x, count * sizeof(double));
            continue;
        }
        const int b = mj_name2id(m, mjOBJ_BODY, name);
        if (b < 0 || m->body_jntnum[b] != 1 || m->jnt_type[m->body_jntadr[b]] != mjJNT_FREE || count != 6) return 0;
        double turn[3], offset[3];
        mj_forward(m, d);
        mju_rotVecQuat(turn, x, d->xquat + 4 * b);
        mju_sub3(offset, d->xpos + 3 * b, d->xipos + 3 * b);
        double* v = d->qvel + m->jnt_dofadr[m->body_jntadr[b]];
        mju_cross(v, turn, offset);
        mju_addTo3(v, x + 3);
        mju_copy3(v + 3, x);
    }
    return 1;
}

int main(int count, char** arguments) {
    if (count == 2 && !strcmp(arguments[1], "version")) {
        printf("%s\n", mj_versionString());
        return 0;
    }
    if (getenv("IMPORT_STEPS")) steps_per_half = atoi(getenv("IMPORT_STEPS"));
    char line[65536];
    while (fgets(line, sizeof line, stdin)) {
        char* field[5];
        char* rest = line;
        line[strcspn(line, "\n")] = 0;
        for (int i = 0; i < 5; ++i) field[i] = strsep(&rest, "\t");
        char error[1000] = "";
        mjModel* m = mj_loadXML(field[1], NULL, error, sizeof error);
        if (!m) {
            for (char* c = error; *c; ++c)
                if (*c == '"' || *c == '\n' || *c == '\\') *c = ' ';
            printf("{\"id\":\"%s\",\"error\":\"%s\"}\n", field[0], error);
            fflush(stdout);
            continue;
        }
        if (strcmp(field[2], "file"))
            sscanf(field[2], "%lf %lf %lf", m->opt.gravity, m->opt.gravity + 1, m->opt.gravity + 2);
        m->opt.disableflags |= mjDSBL_CONSTRAINT | mjDSBL_CONTACT;
        drop(m, field[3]);
        mjData* d = mj_makeData(m);
        // dof_M0, used as the mass matrix of simple bodies, also contains the armature
        mj_setConst(m, d);
        mj_resetData(m, d);
        if (!start(m, d, field[4])) {
            printf("{\"id\":\"%s\",\"error\":\"the start cannot be set\"}\n", field[0]);
            continue;
        }
        printf("{\"id\":\"%s\",", field[0]);
        print_numbers("gravity", m->opt.gravity, 3);
        printf(",\"bodies\":[");
        for (int b = 1; b < m->nbody; ++b) {
            const char* name = mj_id2name(m, mjOBJ_BODY, b);
            printf("%s{\"name\":\"%s\",\"mass\":%.17g,\"welded_to\":%d}", b > 1 ? "," : "", name ? name : "",
                   m->body_mass[b], m->body_weldid[b] - 1);
        }
        printf("],\"moments\":[");
        print_moment(m, d, 0, 1);
        double* work = malloc(sizeof(double) * 3 * (m->nq + m->nv + 1));
        for (int half = 1; half <= 2; ++half) {
            for (int i = 0; i < steps_per_half; ++i) step(m, d, 0.5 * duration / steps_per_half, work);
            print_moment(m, d, 0.5 * duration * half, 0);
        }
        printf("]}\n");
        fflush(stdout);
        free(work), mj_deleteData(d), mj_deleteModel(m);
    }
    return 0;
}
