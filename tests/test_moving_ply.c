/* Reads .ply files of moving scenes, made by the test: Spacetime Gaussians' lite model, SuperSplat 4D's and FTGS. */
#include "moving_bytes.h"

enum { ROWS = 5, MOST = 80 };

static const char *const still[] = {"x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2", "opacity",
                                    "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"};
static const char *const lite[] = {"trbf_center", "trbf_scale", "motion_0", "motion_1", "motion_2", "motion_3",
                                   "motion_4", "motion_5", "motion_6", "motion_7", "motion_8", "omega_0", "omega_1",
                                   "omega_2", "omega_3"};
static const char *const ftgs[] = {"time", "log_duration", "velocity_0", "velocity_1", "velocity_2"};
enum { STILL = 17, LITE = 15, LINEAR = 5, FTGS = 5 };

static const char *names[MOST];
static int count;
static double values[ROWS][MOST];

static void begin(void)
{
    memcpy(names, still, sizeof still);
    count = STILL;
}

static void add(const char *const *more, int n)
{
    memcpy(names + count, more, (size_t)n * sizeof *more);
    count += n;
}

static double value(int row, const char *name)
{
    for (int i = 0; i < count; i++)
        if (!strcmp(names[i], name))
            return values[row][i];
    return 0;
}

/* Properties are written in the reverse order if `is_turned`. */
static void make(const char *comments, const char *format, int is_turned)
{
    unsigned state = 12345;
    size = 0;
    put("ply\nformat %s 1.0\n%selement vertex %d\n", format, comments, ROWS);
    for (int i = 0; i < count; i++)
        put("property float %s\n", names[is_turned ? count - 1 - i : i]);
    put("end_header\n");
    for (int row = 0; row < ROWS; row++)
        for (int i = 0; i < count; i++) {
            state = state * 1664525u + 1013904223u;
            const int at = is_turned ? count - 1 - i : i;
            values[row][at] = (double)(float)((state >> 8) / 8388608.0 - 1);
            if (*format == 'a')
                put("%.9g%s", values[row][at], i == count - 1 ? "\n" : " ");
            else
                put_float((float)values[row][at]);
        }
    put_file(size);
}

static fxs_gaussian gaussians[ROWS + 1];
static fxs_motion motions[ROWS + 1];

/* Times of the file are t / unit + start / unit, its fades are exp(-k (d / s)^2). */
static void check_motion(const char *centre, const char *scale, const char *drift, int degree, int turns, double unit,
                         double start, double k, double least)
{
    for (int row = 0; row < ROWS; row++)
        for (double t = 0; t <= 1.25; t += 0.25) {
            const moment_gaussian got = at_moment(&gaussians[row], &motions[row], t * unit);
            const double d = t + start / unit - value(row, centre), s = fmax(exp(value(row, scale)), least);
            const double opacity = 1 / (1 + exp(-value(row, "opacity"))) * exp(-k * pow(d / s, 2));
            CHECK(is_near(got.opacity, opacity, 1e-5));
            for (int i = 0; i < 3; i++) {
                double x = value(row, still[i]);
                for (int n = 0; n < degree; n++) {
                    char name[16];
                    snprintf(name, sizeof name, "%s_%d", drift, 3 * n + i);
                    x += pow(d, n + 1) * value(row, name);
                }
                CHECK(is_near(got.position[i], x, 1e-5));
            }
            for (int i = 0; i < 4; i++) {
                char name[16];
                snprintf(name, sizeof name, "omega_%d", i);
                const double r = value(row, still[13 + i]) + (turns ? d * value(row, name) : 0);
                CHECK(is_near(got.rotation[i], r, 1e-5));
            }
        }
}

static void check_colours(int direct)
{
    for (int row = 0; row < ROWS; row++)
        for (int c = 0; c < 3; c++) {
            const double given = value(row, still[6 + c]), want = direct ? (given - 0.5) / 0.28209479177387814 : given;
            CHECK(is_near((double)gaussians[row].dc[c], want, 1e-6));
        }
}

static int read_made(const char *comments, const char *format, int is_turned)
{
    make(comments, format, is_turned);
    if (CHECK(read_moving(gaussians, motions, ROWS + 1) == ROWS))
        return !info.unused[0] && info.time.loops == 1 && info.time.fades == 1 && info.time.least == 0;
    printf("  %s\n", message.text);
    return 0;
}

static void lite_model(void)
{
    static const char *const formats[] = {"binary_little_endian", "ascii"};
    begin();
    add(lite, LITE);
    for (int format = 0; format < 2; format++)
        for (int is_turned = 0; is_turned < 2; is_turned++) {
            if (!CHECK(read_made("", formats[format], is_turned)))
                continue;
            CHECK(info.time.duration == 1 && info.time.rate == 0 && info.time.degree == 3 && info.time.turns == 1);
            check_motion("trbf_center", "trbf_scale", "motion", 3, 1, 1, 0, 1, 0);
            check_colours(1);
        }
    CHECK(read_made("comment n_frames 50\ncomment fps 25\n", *formats, 0));
    CHECK(info.time.duration == 2 && info.time.rate == 25);
    check_motion("trbf_center", "trbf_scale", "motion", 3, 1, 2, 0, 1, 0);
}

/* SuperSplat 4D's times are seconds, and its colours are SH. */
static void supersplat_4d(void)
{
    static const char *const comments[] = {
        "comment cfg_args: duration=2.0 start=0.5 fps=30.0 sh_degree=0\n",
        "comment cfg_args: Namespace(duration=2.0, start=0.5, fps=30.0, sh_degree=0)\n",
        "comment cfg_args: start=0.5 duration=2.0 culling=0.005 a=1 b=2 c=3 fps=30.0\n"
    };
    for (int i = 0; i < 3; i++)
        for (int with_all = 0; with_all < 2; with_all++) {
            begin();
            add(lite, with_all ? LITE : LINEAR);
            if (!CHECK(read_made(comments[i], "binary_little_endian", 0)))
                continue;
            CHECK(info.time.duration == 2 && info.time.rate == 30 && info.time.turns == with_all);
            CHECK(info.time.degree == (with_all ? 3 : 1));
            check_motion("trbf_center", "trbf_scale", "motion", with_all ? 3 : 1, with_all, 1, 0.5, 1, 0);
            check_colours(0);
        }
}

#define FTGS_HEAD "comment ftgs_version 1\ncomment time_units normalized\ncomment sh_degree 0\n"

static void ftgs_version_1(void)
{
    begin();
    add(ftgs, FTGS);
    CHECK(read_made(FTGS_HEAD "comment use_velocity 1\ncomment min_duration 0.75\ncomment opacity_floor 0.0001\n"
                    "comment n_frames 61\n", "binary_little_endian", 0));
    CHECK(info.time.duration == 1 && info.time.rate == 0 && info.time.degree == 1 && info.time.turns == 0);
    check_motion("time", "log_duration", "velocity", 1, 0, 1, 0, 0.5, 0.75);
    check_colours(0);
    CHECK(read_made(FTGS_HEAD "comment use_velocity 0\ncomment min_duration 0.02\ncomment opacity_floor 0\n"
                    "comment n_frames 61\ncomment fps 20\n", "binary_little_endian", 1));
    CHECK(info.time.duration == 3 && info.time.rate == 20 && info.time.degree == 0);
    check_motion("time", "log_duration", "velocity", 0, 0, 3, 0, 0.5, 0.02);
}

static void ftgs_with_sh(void)
{
    static char rest[45][16];
    const char *more[45];
    for (int i = 0; i < 45; i++) {
        snprintf(rest[i], sizeof rest[i], "f_rest_%d", i);
        more[i] = rest[i];
    }
    begin();
    add(more, 45);
    add(ftgs, FTGS);
    CHECK(read_made(FTGS_HEAD, "binary_little_endian", 0) && info.sh_degree == 3);
    for (int row = 0; row < ROWS; row++)
        for (int i = 0; i < 45; i++)
            CHECK((double)gaussians[row].sh[3 * (i % 15) + i / 15] == value(row, rest[i]));
    check_motion("time", "log_duration", "velocity", 1, 0, 1, 0, 0.5, 0);
}

/* Without the comments that say what times mean, columns of FTGS are not read. */
static void columns_without_comments(void)
{
    begin();
    add(ftgs, FTGS);
    make("", "binary_little_endian", 0);
    CHECK(read_file(gaussians, ROWS) == 0 && info.time.duration == 0 && !strcmp(info.unused, "time, velocity_*"));
}

/* Many Gaussians come in several calls; the motions belong to the last call. */
static void many_rows(void)
{
    enum { MANY = 1500 };
    static fxs_gaussian many[MANY + 1];
    static fxs_motion moves[MANY + 1];
    size = 0;
    put("ply\nformat binary_little_endian 1.0\n" FTGS_HEAD "element vertex %d\n", MANY);
    for (int i = 0; i < STILL; i++)
        put("property float %s\n", still[i]);
    for (int i = 0; i < FTGS; i++)
        put("property float %s\n", ftgs[i]);
    put("end_header\n");
    for (int row = 0; row < MANY; row++)
        for (int i = 0; i < STILL + FTGS; i++)
            put_float((float)(row + i));
    put_file(size);
    CHECK(read_moving(many, moves, MANY + 1) == MANY);
    for (int row = 0; row < MANY; row++)
        CHECK(many[row].position[0] == (float)row && moves[row].centre == (float)(row + STILL) &&
              moves[row].drift[0][2] == (float)(row + STILL + 4));
}

static void faults(void)
{
    static const struct { const char *comments, *words; } cases[] = {
        {"comment ftgs_version 2\n", "no valid comment ftgs_version of a moving scene"},
        {"comment ftgs_version nan\n", "no valid comment ftgs_version"},
        {FTGS_HEAD "comment min_duration 0\n", "no valid comment min_duration"},
        {FTGS_HEAD "comment min_duration -1\n", "no valid comment min_duration"},
        {FTGS_HEAD "comment opacity_floor 0.5\n", "no valid comment opacity_floor"},
        {FTGS_HEAD "comment use_velocity yes\n", "no valid comment use_velocity"},
        {FTGS_HEAD "comment n_frames 0\n", "no valid comment n_frames"},
        {FTGS_HEAD "comment n_frames 1e300\n", "no valid comment n_frames"},
        {FTGS_HEAD "comment n_frames 10\ncomment fps 0\n", "no valid comment fps"},
    };
    begin();
    add(ftgs, FTGS);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        make(cases[i].comments, "binary_little_endian", 0);
        check_fails(cases[i].words);
    }
    count--;
    make(FTGS_HEAD, "binary_little_endian", 0);
    check_fails("an FTGS scene whose element vertex has no property velocity_2");
    begin();
    add(lite, LITE);
    make("comment cfg_args: duration=0 start=0 fps=30\n", "binary_little_endian", 0);
    check_fails("no valid comment duration of a moving scene");
    make("comment cfg_args: duration=1 start=x fps=30\n", "binary_little_endian", 0);
    check_fails("no valid comment start of a moving scene");
    make("", "binary_little_endian", 0);
    check_cut_fails(size - 1, "the header asks for at least");
    static const char *const full[] = {"f_t_0", "f_t_1", "f_t_2"};
    add(full, 3);
    make("", "binary_little_endian", 0);
    check_fails("the full model of Spacetime Gaussians (f_t_*), whose colours need the network beside it");
}

/* Numbers that are not finite pass, as in a still .ply; the packer leaves such Gaussians out. */
static void not_finite(void)
{
    begin();
    add(lite, LITE);
    make("", "binary_little_endian", 0);
    put_float_at(size - 4 * LITE, NAN);
    put_float_at(size - 4 * (LITE - 1), -INFINITY);
    put_float_at(size - 4 * (LITE - 2), INFINITY);
    CHECK(read_file(gaussians, ROWS + 1) == 0);
    fxs_scene_file *file;
    CHECK(fxs_scene_file_open_memory(path, bytes, file_size, NULL, &file, &info, &message) == 0);
    CHECK(fxs_scene_file_read(file, gaussians, ROWS, &message) == ROWS);
    const fxs_motion *last = fxs_scene_file_motions(file) + ROWS - 1;
    CHECK(isnan(last->centre) && last->fade == 0 && last->drift[0][0] == INFINITY);
    fxs_scene_file_close(file);
}

/* Scenes that a network deforms: the weights, by their first bytes, and the folder that has them. */
static void networks(void)
{
    static const char said[] = "a neural network of PyTorch, which is not run";
    char folder[] = "/tmp/fixsplat_network_XXXXXX", name[64];
    fxs_scene_file *file;
    size = 0;
    put("PK%c%c", 3, 4);
    memset(bytes + size, 0, 26);
    size += 26;
    bytes[26] = 16;
    put("archive/data.pkl....");
    check_fails(said);
    bytes[26] = 21;
    check_fails("");
    if (!CHECK(mkdtemp(folder) != NULL))
        return;
    snprintf(name, sizeof name, "%s/deformation.pth", folder);
    FILE *stream = fopen(name, "wb");
    CHECK(stream && !fclose(stream));
    CHECK(fxs_scene_file_open(folder, NULL, &file, &info, &message) == FXS_ERR_FILE && strstr(message.text, said));
    CHECK(!unlink(name) && !rmdir(folder));
}

int main(void)
{
    RUN(lite_model);
    RUN(supersplat_4d);
    RUN(ftgs_version_1);
    RUN(ftgs_with_sh);
    RUN(columns_without_comments);
    RUN(many_rows);
    RUN(faults);
    RUN(not_finite);
    RUN(networks);
    return check_report();
}
