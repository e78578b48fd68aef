/* Tests the readers of cameras that photogrammetry programs export: each convention, faulty files, truncated files. */
#include "photo_folder.h"
#include "src/fit/blocks.h"
#include "src/camera/camera_internal.h"

enum { CAMERAS = 9, WIDE = 64, HIGH = 48 };

/* poses of the test's cameras: heading, pitch and roll in degrees, then position east, north, up */
static const double poses[CAMERAS][6] = {
    {0, 0, 0, 0, 0, 0}, {90, 90, 0, 1, 2, 3}, {-180, 45, 180, -4, 5, 0.5}, {271.5, -30, 91, 3, -2, 1},
    {359, 179, -179.5, 0.25, 1.5, -7}, {-33.25, 87.5, 14.75, 0.3, -0.4, 1.9}, {720.5, 12, -270, 8, 9, 10},
    {180, -90, 45, 2, 2, 2}, {135, 66, -120, -1, -1, 1},
};

static const double focal = 70, middle[2] = {31, 25.5};
static const double k[4] = {-0.12, 0.04, -0.01, 0.003}, p[2] = {0.004, -0.003};

/* Computes the camera-to-world matrix with columns right, up and back: Rz(-heading) Rx(pitch) Ry(roll). */
static void turned(const double pose[6], double m[9])
{
    const double d = acos(-1) / 180, h = -pose[0] * d, a = pose[1] * d, b = pose[2] * d;
    const double z[9] = {cos(h), -sin(h), 0, sin(h), cos(h), 0, 0, 0, 1};
    const double x[9] = {1, 0, 0, 0, cos(a), -sin(a), 0, sin(a), cos(a)};
    const double y[9] = {cos(b), 0, sin(b), 0, 1, 0, -sin(b), 0, cos(b)};
    double zx[9];
    for (int i = 0; i < 9; i++)
        zx[i] = z[i / 3 * 3] * x[i % 3] + z[i / 3 * 3 + 1] * x[3 + i % 3] + z[i / 3 * 3 + 2] * x[6 + i % 3];
    for (int i = 0; i < 9; i++)
        m[i] = zx[i / 3 * 3] * y[i % 3] + zx[i / 3 * 3 + 1] * y[3 + i % 3] + zx[i / 3 * 3 + 2] * y[6 + i % 3];
}

/* Computes the world-to-camera matrix of a pose, with rows right, down and forward. */
static void rows_of(const double pose[6], double r[9])
{
    double m[9];
    turned(pose, m);
    for (int i = 0; i < 3; i++) {
        r[i] = m[3 * i];
        r[3 + i] = -m[3 * i + 1];
        r[6 + i] = -m[3 * i + 2];
    }
}

/* Writes a .csv of cameras with the given number of radial lens coefficients. */
static void write_csv(int lens)
{
    say("#cameras %d\r\n#name,x,y,alt,heading,pitch,roll,f,px,py,k1,k2,k3,k4,t1,t2\r\n", CAMERAS);
    for (int i = 0; i < CAMERAS; i++) {
        const double *o = poses[i], off[2] = {(middle[0] - WIDE / 2.0) / WIDE, (middle[1] - HIGH / 2.0) / WIDE};
        say("%s%d.ppm%s,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g", i == 2 ? "\"" : "", i,
            i == 2 ? "\"" : "", o[3], o[4], o[5], o[0], o[1], o[2], focal * 36 / WIDE, off[0], off[1]);
        for (int j = 0; j < 4; j++)
            say(",%.17g", j < lens ? k[j] : 0);
        say(",%.17g,%.17g\r\n", lens ? p[0] : 0, lens ? p[1] : 0);
    }
    put_text("e/cameras.csv");
}

static void write_bundler(int lens)
{
    say("# Bundle file v0.3\n%d 2\n", CAMERAS + 1);
    for (int i = 0; i <= CAMERAS; i++) {
        double r[9], t[3] = {0, 0, 0};
        rows_of(poses[i % CAMERAS], r);
        for (int row = 0; row < 3; row++)
            for (int j = 0; j < 3; j++)
                t[row] -= r[3 * row + j] * poses[i % CAMERAS][3 + j];
        say("%.17g %.17g %.17g\n", i < CAMERAS ? focal : 0, lens ? k[0] : 0, lens ? k[1] : 0);
        for (int row = 0; row < 3; row++)
            for (int j = 0; j < 3; j++)
                say("%.17g%c", row ? -r[3 * row + j] : r[3 * row + j], j == 2 ? '\n' : ' ');
        say("%.17g %.17g %.17g\n", t[0], -t[1], -t[2]);
    }
    say("1 2 -9\n10 20 30\n2 0 5 1.5 2.5 1 7 3.5 4.5\n3 4 9\n11 21 31\n0\n");
    put_text("e/bundle.out");
    for (int i = 0; i < CAMERAS; i++)
        say("%d.ppm%s\n", i, i % 2 ? " 0 70.5" : "");
    say("never placed.ppm\n");
    put_text("e/list.txt");
}

#ifdef FXS_WITH_EXPAT

static double away;                /* shift along x in the transform that the Metashape file states */
static const double placed[9] = {0.6, 0, -0.8, 0, 1, 0, 0.8, 0, 0.6}, moved[3] = {5, -6, 7}, scale = 2.5;

/* Writes a Metashape .xml of cameras. owner: the XML element that states the transform, "component", "chunk" or ""
   (none). */
static void write_metashape(const char *owner, const char *type, const char *calibration)
{
    const int whole = *owner != 0, component = !strcmp(owner, "component");
    char transform[512] = "";
    if (whole)
        snprintf(transform, sizeof transform, "<transform><rotation locked=\"true\">"
                 "%g %g %g %g %g %g %g %g %g</rotation><translation>%.17g %.17g\n%.17g</translation><scale>%g</scale>"
                 "</transform>", placed[0], placed[1], placed[2], placed[3], placed[4], placed[5], placed[6], placed[7],
                 placed[8], moved[0] + away, moved[1], moved[2], scale);
    say("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<document version=\"2.0.0\">\n<chunk label=\"C\" enabled=\"true\">"
        "<sensors next_id=\"1\"><sensor id=\"0\" label=\"unknown\" type=\"frame\"/><sensor id=\"7\" type=\"%s\">"
        "<resolution width=\"%d\" height=\"%d\"/><property name=\"layer_index\" value=\"0\"/>"
        "<calibration type=\"frame\" class=\"initial\"><f>99</f></calibration>"
        "<calibration type=\"frame\" class=\"adjusted\"><resolution width=\"9\" height=\"9\"/>"
        "<f>%.17g</f><cx>%.17g</cx><cy>%.17g</cy>%s</calibration>"
        "<calibration type=\"frame\" class=\"initial\"><f>98</f></calibration>"
        "<covariance><params>f cx</params><coeffs>1 2 3 4</coeffs></covariance></sensor></sensors>\n"
        "<components next_id=\"1\"><component id=\"0\" label=\"one\">%s</component></components>\n"
        "<cameras><group id=\"0\">", type, WIDE, HIGH, focal, middle[0] - WIDE / 2.0, middle[1] - HIGH / 2.0,
        calibration, component ? transform : "");
    for (int i = 0; i < CAMERAS; i++) {
        double r[9], at[3];
        rows_of(poses[i], r);
        say("<camera id=\"%d\" sensor_id=\"7\" component_id=\"0\" label=\"%d.ppm\"><transform>", i, i);
        for (int j = 0; j < 3; j++) {
            at[j] = poses[i][3 + j];
            for (int n = 0; n < 3 && whole; n++)
                at[j] = (n ? at[j] : 0) + placed[3 * n + j] * (poses[i][3 + n] - moved[n]) / scale;
        }
        for (int j = 0; j < 3; j++) {
            for (int axis = 0; axis < 3; axis++) {
                double x = whole ? 0 : r[3 * axis + j];
                for (int n = 0; n < 3 && whole; n++)
                    x += placed[3 * n + j] * r[3 * axis + n];
                say("%.17g ", x);
            }
            say("%.17g ", at[j]);
        }
        say("0 0 0 1</transform><rotation_covariance>1 2 3</rotation_covariance></camera>\n");
        if (i == 3)
            say("</group><camera id=\"50\" sensor_id=\"7\" label=\"not aligned\"/>"
                "<camera id=\"51\" sensor_id=\"7\" label=\"off\" enabled=\"false\"><transform>"
                "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</transform></camera>");
    }
    say("</cameras>%s</chunk></document>\n", component ? "" : transform);
    put_text("e/cameras.xml");
}
#endif

static fxs_view_list read_list(const char *name)
{
    static char path[512];
    fxs_view_list list = {.path = path, .message = &message};
    snprintf(path, sizeof path, "%s", in_folder(name));
    if (!CHECK(!fxs_view_list_read(&list)))
        printf("  %s\n", message.text);
    return list;
}

static void check_poses(const fxs_view_list *list, int width, int height, const double centre[2], double focal_of)
{
    if (!CHECK(list->count == CAMERAS))
        return;
    for (int i = 0; i < CAMERAS; i++) {
        double r[9];
        fxs_view v = list->views[i].view;
        rows_of(poses[i], r);
        if (list->views[i].sizeless) {
            CHECK(v.width == 800 && v.height == 800);
            fxs_view_set_size(&list->views[i], &v, width, height);
        }
        CHECK(list->views[i].image[0] == '0' + i && v.width == width && v.height == height);
        CHECK(fabs(v.fx - focal_of) < 1e-11 && fabs(v.fy - focal_of) < 1e-11);
        CHECK(fabs(v.cx - centre[0]) < 1e-11 && fabs(v.cy - centre[1]) < 1e-11);
        for (int j = 0; j < 9; j++)
            if (!CHECK(fabs(v.rotation[j] - r[j]) < 1e-14))
                printf("  camera %d, %d: %g for %g\n", i, j, v.rotation[j], r[j]);
        for (int j = 0; j < 3; j++)
            CHECK(fabs(v.position[j] - poses[i][3 + j]) < 1e-13);
    }
}

/* Checks the radial and tangential terms of a lens. The expected values come from Brown's formula, with
   `coefficients` radial terms. */
static void check_lens(const fxs_lens *lens, int coefficients, int fisheye, double skew)
{
    for (double x = -0.6; x < 0.7; x += 0.3)
        for (double y = -0.45; y < 0.5; y += 0.3) {
            const double radius = hypot(x, y), t = fisheye && radius > 0 ? atan(radius) / radius : 1;
            const double u = x * t, v = y * t, s = u * u + v * v;
            double series = 1, bent[2];
            for (int i = 0; i < coefficients; i++)
                series += k[i] * pow(s, i + 1);
            const double py = coefficients == 4 ? p[0] : 0, px = coefficients == 4 ? p[1] : 0;
            const double down = v * series + py * (s + 2 * v * v) + 2 * px * u * v;
            const double right = u * series + px * (s + 2 * u * u) + 2 * py * u * v + skew * down;
            fxs_lens_bend(lens, x, y, bent);
            CHECK(fabs(bent[0] - right) < 1e-14 && fabs(bent[1] - down) < 1e-14);
        }
}

static void csv(void)
{
    const double upright[2] = {HIGH / 2.0 - 1, WIDE / 2.0 + 1.5}, twice[2] = {62, 51};
    write_csv(4);
    fxs_view_list list = read_list("e/cameras.csv");
    check_poses(&list, WIDE, HIGH, middle, focal);
    /* the focal length and the image centre scale with the longer side of the picture */
    check_poses(&list, HIGH, WIDE, upright, focal);
    check_poses(&list, 2 * WIDE, 2 * HIGH, twice, 2 * focal);
    for (size_t i = 0; i < list.count; i++)
        check_lens(&list.views[i].lens, 4, 0, 0);
    CHECK(list.count && list.views[0].view.bends);
    fxs_view_list_free(&list);
    say("#name,f,roll,pitch,heading,alt,y,x,other\nD:\\set\\a.jpg,36,0,0,0,3,2,1,word\n# no camera\n\n"
        "C:/a/b c.jpg,18,0,0,0,6,5,4,\n");
    put_text("e/cameras.csv");
    list = read_list("e/cameras.csv");
    if (CHECK(list.count == 2)) {
        const fxs_view *v = &list.views[0].view;
        CHECK(!strcmp(list.views[0].image, "a.jpg") && !strcmp(list.views[1].image, "b c.jpg"));
        CHECK(v->fx == 800 && v->cx == 400 && v->position[0] == 1 && v->position[2] == 3 && !v->bends);
    }
    fxs_view_list_free(&list);
    say("\xef\xbb\xbf#name;x;y;alt;heading;pitch;roll;f\n\"a,b;c.jpg\";1;2.5;-3,5;0;0;0;36\n"
        "sub\\d.jpg;1;2;3;0;0;0;36\n");
    put_text("e/cameras.csv");
    list = read_list("e/cameras.csv");
    if (CHECK(list.count == 2)) {
        const double *at = list.views[0].view.position;
        CHECK(!strcmp(list.views[0].image, "a,b;c.jpg") && !strcmp(list.views[1].image, "sub\\d.jpg"));
        CHECK(at[0] == 1 && at[1] == 2.5 && at[2] == -3.5);
    }
    fxs_view_list_free(&list);
}

static void bundler(void)
{
    const double centre[2] = {WIDE / 2.0, HIGH / 2.0};
    static const char *const lists[] = {"e/bundle.list.txt", "e/bundle.out.list.txt", "e/bundle.txt", "list.txt"};
    write_bundler(1);
    fxs_view_list list = read_list("e/bundle.out");
    check_poses(&list, WIDE, HIGH, centre, focal);
    for (size_t i = 0; i < list.count; i++)
        check_lens(&list.views[i].lens, 2, 0, 0);
    fxs_view_list_free(&list);
    CHECK(!rename(in_folder("e/list.txt"), in_folder("moved")));
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
        char from[512];
        strcpy(from, in_folder("moved"));
        CHECK(!rename(from, in_folder(lists[i])));
        list = read_list("e/bundle.out");
        CHECK(list.count == CAMERAS);
        fxs_view_list_free(&list);
        strcpy(from, in_folder(lists[i]));
        CHECK(!rename(from, in_folder("moved")));
    }
    remove(in_folder("moved"));
    say("a set 5\n");   /* the image name "a set 5" ends in a number after a space */
    put_text("e/x.list.txt");
    say("# Bundle file v0.3\n1 0\n9 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 0\n");
    put_text("e/x.out");
    list = read_list("e/x.out");
    CHECK(list.count == 1 && !strcmp(list.views[0].image, "a set 5"));
    fxs_view_list_free(&list);
    remove(in_folder("e/x.list.txt"));
}

#ifdef FXS_WITH_EXPAT

#define LENS "<k1>-0.12</k1><k2>0.04</k2><k3>-0.01</k3><k4>0.003</k4><p1>-0.003</p1><p2>0.004</p2>"

static void metashape(void)
{
    static const char *const owners[] = {"", "chunk", "component"};
    for (int i = 0; i < 6; i++) {
        write_metashape(owners[i % 3], i > 2 ? "fisheye" : "frame", LENS);
        fxs_view_list list = read_list("e/cameras.xml");
        check_poses(&list, WIDE, HIGH, middle, focal);
        for (size_t n = 0; n < list.count; n++)
            check_lens(&list.views[n].lens, 4, i > 2, 0);
        fxs_view_list_free(&list);
    }
    for (int far = 0; far < 2; far++) {
        /* camera positions from 4e6 on count as geocentric, and the reader subtracts their offset */
        away = far ? 4e6 : 60000;
        write_metashape("component", "frame", LENS);
        fxs_view_list list = read_list("e/cameras.xml");
        CHECK(list.moved == far);
        for (int i = 0; i < CAMERAS && list.count == CAMERAS; i++)
            for (int j = 0; j < 3; j++)
                CHECK(fabs(list.views[i].view.position[j] - poses[i][3 + j] -
                           (far ? -moved[j] : j ? 0 : away)) < 1e-8);
        fxs_view_list_free(&list);
    }
    away = 0;
    write_metashape("", "frame", LENS "<b1>2</b1><b2>-0.9</b2>");
    fxs_view_list list = read_list("e/cameras.xml");
    if (CHECK(list.count == CAMERAS)) {
        CHECK(list.views[0].view.fx == focal + 2 && list.views[0].view.fy == focal);
        check_lens(&list.views[0].lens, 4, 0, -0.9 / (focal + 2));
    }
    fxs_view_list_free(&list);
}

static void metashape_components(void)
{
    static const struct { double places[2], origin; } sets[] = {
        {{4e6 + 5.25, 4e6 + 105.25}, 4e6 + 5}, {{60000, 70000.5}, 70001}, {{-70000.75, 60000}, -70001},
        {{60000, 50000.5}, 0},
    };
    for (size_t i = 0; i < sizeof sets / sizeof *sets; i++) {
        const char *pose = "<transform>1 0 0 0.5 0 1 0 0 0 0 1 0 0 0 0 1</transform></camera>";
        say("<document><chunk><sensors><sensor id=\"0\"><resolution width=\"64\" height=\"48\"/><calibration><f>70</f>"
            "</calibration></sensor></sensors><components>");
        for (int c = 0; c < 2; c++)
            say("<component id=\"%d\"><transform><translation>%.17g 0 -9</translation></transform></component>", 5 - c,
                sets[i].places[c]);
        say("</components><cameras><camera label=\"a\" sensor_id=\"0\" component_id=\"5\">%s"
            "<camera label=\"b\" sensor_id=\"0\" component_id=\"4\">%s</cameras></chunk></document>", pose, pose);
        put_text("e/x.xml");
        fxs_view_list list = read_list("e/x.xml");
        CHECK(list.moved == (sets[i].origin != 0));
        for (size_t c = 0; c < 2 && CHECK(list.count == 2); c++) {
            const double *at = list.views[c].view.position;
            if (!CHECK(at[0] == 0.5 + (sets[i].places[c] - sets[i].origin) && at[1] == 0 &&
                       at[2] == (list.moved ? 0 : -9)))
                printf("  set %zu, component %zu: %.17g, %g, %g\n", i, c, at[0], at[1], at[2]);
        }
        fxs_view_list_free(&list);
    }
    remove(in_folder("e/x.xml"));
}
#endif

/* Camera exports give the same undistorted photographs as COLMAP files of the same cameras, to the pixel. */
static void photographs(void)
{
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options), .hold_out = 3};
    static const char *const files[] = {"e/cameras.csv", "e/cameras.xml"};
    fxs_photos first;
    for (int i = 0; i < CAMERAS; i++) {
        char name[32];
        sprintf(name, "e/images/%d.ppm", i);
        put_ppm(name, WIDE, HIGH, NULL);
    }
    say("1 FULL_OPENCV %d %d %g %g %g %g %.17g %.17g %.17g %.17g %.17g 0 0 0\n", WIDE, HIGH, focal, focal, middle[0],
        middle[1], k[0], k[1], p[0], p[1], k[2]);
    put_text("e/cameras.txt");
    for (int i = 0; i < CAMERAS; i++) {
        double r[9], q[4], t[3] = {0, 0, 0};
        rows_of(poses[i], r);
        fxs_quaternion_of(r, q);
        for (int j = 0; j < 9; j++)
            t[j / 3] -= r[j] * poses[i][3 + j % 3];
        say("%d %.17g %.17g %.17g %.17g %.17g %.17g %.17g 1 %d.ppm\n\n", i, q[0], q[1], q[2], q[3], t[0], t[1], t[2],
            i);
    }
    put_text("e/images.txt");
    if (!CHECK(!read_photos("e/images.txt", &options)))
        printf("  %s\n", message.text);
    first = photos;
    memset(&photos, 0, sizeof photos);
    write_csv(3);
#ifdef FXS_WITH_EXPAT
    write_metashape("chunk", "frame", "<k1>-0.12</k1><k2>0.04</k2><k3>-0.01</k3><p1>-0.003</p1><p2>0.004</p2>");
    for (size_t f = 0; f < 2; f++) {
#else
    for (size_t f = 0; f < 1; f++) {
#endif
        if (!CHECK(!read_photos(files[f], &options) && photos.fit_count == first.fit_count &&
                   photos.held_out_count == first.held_out_count)) {
            printf("  %s: %s\n", files[f], message.text);
            continue;
        }
        CHECK(photos.points_are_random);
        for (size_t i = 0; i < photos.fit_count; i++) {
            const fxs_view *v = &photos.fit[i].view, *w = &first.fit[i].view;
            int off = 0;
            for (int j = 0; j < 3 * WIDE * HIGH; j++)
                off += abs(photos.fit[i].pixels[j] - first.fit[i].pixels[j]) > 1;
            CHECK(v->name[0] == w->name[0] && fabs(v->fx - w->fx) < 1e-9 && fabs(v->cy - w->cy) < 1e-9 && !off);
            for (int j = 0; j < 9; j++)
                CHECK(fabs(v->rotation[j] - w->rotation[j]) < 1e-14);
        }
    }
    fxs_photos_free(&first);
}

static void points(void)
{
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    for (int i = 0; i < CAMERAS; i++) {
        char name[32];
        sprintf(name, "e/images/%d.ppm", i);
        put_ppm(name, WIDE, HIGH, NULL);
    }
    write_bundler(1);
    if (CHECK(!read_photos("e/bundle.out", &options))) {
        CHECK(photos.point_count == 2 && !photos.points_are_random && photos.points[0].position[2] == -9 &&
              photos.points[1].position[0] == 3 && photos.points[1].colour[1] == 21 &&
              photos.points[0].colour[2] == 30);
        CHECK(photos.fit[0].view.cx == WIDE / 2.0 && photos.fit_count == CAMERAS);
    } else {
        printf("  %s\n", message.text);
    }
    write_csv(0);
    say("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
        "1 2 -9\n");
    put_text("e/points.ply");
    CHECK(!read_photos("e/cameras.csv", &options) && photos.point_count == 1 && photos.points[0].position[1] == 2);
    remove(in_folder("e/points.ply"));
    CHECK(!remove(in_folder("e/cameras.txt")) && !remove(in_folder("e/images.txt")));
    remove(in_folder("e/cameras.xml"));
    CHECK(!read_photos("e", &options) && photos.points_are_random);
    remove(in_folder("e/images/3.ppm"));
    check_refused("e", &options, FXS_ERR_FILE, "3.ppm: No such file or directory (a photograph of ");
    CHECK(strstr(message.text, "cameras.csv; skip_bad, --skip-bad, leaves such out)") != NULL);
    check_refused("e/bundle.out", &options, FXS_ERR_FILE, "bundle.out; skip_bad, --skip-bad, leaves such out)");
    put_ppm("e/images/3.ppm", WIDE, HIGH, NULL);
    remove(in_folder("e/cameras.csv"));
    CHECK(!read_photos("e", &options) && photos.point_count == 2);
}

static void blocks(void)
{
    static const char *const files[] = {"e/cameras.csv", "e/bundle.out"};
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    fxs_fit_block block;
    write_csv(4);
    write_bundler(0);
    for (int i = 0; i < 2; i++) {
        const int error = fxs_fit_block_read(in_folder(files[i]), &options, NULL, 1, 1, &block, &message);
        if (!CHECK(error == FXS_ERR_UNSUPPORTED && strstr(message.text, files[i]) &&
                   strstr(message.text, "states no size") && !block.photos.fit))
            printf("  %d: %s\n", error, error ? message.text : "");
        if (!error)
            fxs_fit_block_free(&block);
    }
}

#ifdef FXS_WITH_EXPAT

static void on_earth(void)
{
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    away = 4e6;
    write_metashape("chunk", "frame", "");
    away = 0;
    CHECK(!read_photos("e/cameras.xml", &options) && photos.fit_count == CAMERAS && photos.points_are_random);
    put_file("e/points.ply", "ply\n", 4);
    check_refused("e/cameras.xml", &options, FXS_ERR_FILE, "points.ply: the cameras of ");
    remove(in_folder("e/points.ply"));
    const char *xml = "<document><chunk><sensors><sensor id=\"0\"><resolution width=\"64\" height=\"48\"/>"
                      "<calibration><f>70</f></calibration></sensor></sensors><cameras>"
                      "<camera label=\"/another/machine/2.ppm\" sensor_id=\"0\"><transform>"
                      "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</transform></camera></cameras></chunk></document>";
    put_file("e/x.xml", xml, strlen(xml));
    CHECK(!read_photos("e/x.xml", &options) && photos.fit_count == 1);
    CHECK(!rename(in_folder("e/images/2.ppm"), in_folder("e/images/z.ppm")));
    check_refused("e/x.xml", &options, FXS_ERR_FILE, "/another/machine/2.ppm: No such file");
    CHECK(!rename(in_folder("e/images/z.ppm"), in_folder("e/images/2.ppm")));
    remove(in_folder("e/cameras.xml"));
}
#endif

static void far_away(void)
{
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    for (int wide = 0; wide < 2; wide++) {
        say("#name,x,y,alt,heading,pitch,roll,f\n0.ppm,500000,4000000,100,0,0,0,36\n1.ppm,%d,4000020,100,0,0,0,36\n",
            wide ? -500000 : 500010);
        put_text("e/cameras.csv");
        if (wide)
            CHECK(!read_photos("e/cameras.csv", &options));
        else
            check_refused("e/cameras.csv", &options, FXS_ERR_FILE, "4000020 units from the origin and 20 from each");
    }
}

static void check_fault(const char *name, const char *content, const char *words)
{
    fxs_view_list list = {.path = in_folder(name), .message = &message};
    put_file(name, content, strlen(content));
    const int error = fxs_view_list_read(&list);
    if (!CHECK(error == FXS_ERR_FILE && strstr(message.text, words) && !strchr(message.text, '\n')))
        printf("  \"%.60s\": %d, \"%s\", expected \"%s\"\n", content, error, error ? message.text : "", words);
    fxs_view_list_free(&list);
}

#define HEAD "#name,x,y,alt,heading,pitch,roll,f,k1\n"

static void csv_faults(void)
{
    static const char *const faults[][2] = {
        {"", "but this is empty"}, {"name,x\n", "no line begins with #name"}, {"#name,x,y\n", "no column alt"},
        {HEAD, "no views"}, {HEAD "a,1,2,3,4,5,6\n", "camera 0: 7 values of 9"},
        {HEAD "a,1,2,3,4,5,6,7,8\nb,1,2,3,4,5,nan,7,8\n", "camera 1: roll is not a finite number"},
        {HEAD "a,1,2,1e999,4,5,6,7,8\n", "camera 0: alt is not"}, {HEAD "a,1,2,,4,5,6,7,8\n", "alt is not"},
        {HEAD ",1,2,3,4,5,6,7,8\n", "camera 0: no name"}, {HEAD "a,1,2,3,4,5,6,0,8\n", "view a: no focal length"},
        {HEAD "a,1,2,3,4,5,6,-9,8\n", "view a: no focal length"},
        {HEAD "\"a,1,2,3,4,5,6,7,8\n", "camera 0: 1 values of 9"},
    };
    for (size_t i = 0; i < sizeof faults / sizeof *faults; i++)
        check_fault("e/x.csv", faults[i][0], faults[i][1]);
    for (int i = 0; i < 70; i++)
        say("%s", i ? ",x" : "#name");
    text[length] = 0;
    length = 0;
    check_fault("e/x.csv", text, "more than 64 columns");
    put_file("e/x.csv", HEAD "a,1,2,3,4,5,6,7,8\n\0", sizeof HEAD + 19);
    fxs_view_list list = {.path = in_folder("e/x.csv"), .message = &message};
    CHECK(fxs_view_list_read(&list) == FXS_ERR_FILE && strstr(message.text, "zero bytes in this text"));
    fxs_view_list_free(&list);
}

#define BUNDLE "# Bundle file v0.3\n"
#define UNIT "1 0 0\n0 1 0\n0 0 1\n0 0 0\n"

static void bundler_faults(void)
{
    static const char *const faults[][2] = {
        {BUNDLE, "does not begin with the numbers"}, {BUNDLE "1\n", "does not begin with the numbers"},
        {BUNDLE "1e300 0\n70 0 0\n" UNIT, "only 1 photographs, but"}, {BUNDLE "0 0\n", "no views"},
        {BUNDLE "-1 0\n", "no views"}, {BUNDLE "1 0\n70 0 0\n1 0 0\n0 1 0\n", "camera 0: not five lines"},
        {BUNDLE "1 0\n70 0 nan\n" UNIT, "camera 0: not five lines"}, {BUNDLE "1 0\n-70 0 0\n" UNIT, "no focal length"},
        {BUNDLE "1 0\n70 0 0\n9 0 0\n0 1 0\n0 0 1\n0 0 0\n", "view a.jpg: rotation not orthonormal"},
        {BUNDLE "1 0\n0 0 0\n" UNIT, "no views"},
    };
    put_file("e/list.txt", "a.jpg\n", 6);
    for (size_t i = 0; i < sizeof faults / sizeof *faults; i++)
        check_fault("e/x.out", faults[i][0], faults[i][1]);
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    put_ppm("e/images/a.jpg", WIDE, HIGH, NULL);
    static const char *const counts[] = {BUNDLE "1 1e300\n70 0 0\n" UNIT,
                                         BUNDLE "1 1\n70 0 0\n" UNIT "1 2 nan\n1 2 3\n0\n",
                                         BUNDLE "1 1\n70 0 0\n" UNIT "1 2 3\n1 2 3\n"};
    static const char *const words[] = {"x.out: point 0: not a position and a colour", "point 0: not a position",
                                        "point 0: cut short"};
    for (int i = 0; i < 3; i++) {
        put_file("e/x.out", counts[i], strlen(counts[i]));
        check_refused("e/x.out", &options, FXS_ERR_FILE, words[i]);
    }
    remove(in_folder("e/list.txt"));
    check_fault("e/x.out", BUNDLE "1 0\n70 0 0\n" UNIT, "x.out: no list of its photographs: expected list.txt beside");
}

#ifdef FXS_WITH_EXPAT

#define SENSOR "<document><chunk><sensors><sensor id=\"0\"><resolution width=\"8\" height=\"6\"/><calibration>"
#define REST "</calibration></sensor></sensors><cameras><camera label=\"a\" sensor_id=\"0\"><transform>"
#define POSE "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"
#define ENDING "</transform></camera></cameras></chunk></document>"

static void metashape_faults(void)
{
    static const char *const faults[][2] = {
        {"", "but this is empty"}, {"<?xml", "line 1: "}, {"<document><chunk>", "line 1: no element found"},
        {"<html/>", "no cameras of Metashape"}, {"<document><chunk/></document>", "no views"},
        {"<document><chunk/>\n<chunk/></document>", "line 2: a second chunk: export one"},
        {"<!DOCTYPE a [<!ENTITY b \"c\">]><document/>", "line 1: a document type is declared: a"},
        {SENSOR "<f>nan</f>" REST POSE ENDING, "not finite numbers, or not so many as there should be: f"},
        {SENSOR "<f>9</f>" REST "1 2" ENDING, "not so many as there should be: transform"},
        {SENSOR "<f>9</f>" REST POSE " 1" ENDING, "not so many as there should be: transform"},
        {SENSOR "" REST POSE ENDING, "view a: no focal length"},
        {SENSOR "<f>9</f><k1>1e400</k1>" REST POSE ENDING, "not finite numbers"},
        {SENSOR "<f>9</f><p3>1</p3>" REST POSE ENDING, "view a: its sensor has p3 or p4"},
        {SENSOR "<f>9</f>" REST "1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1" ENDING, "last row of its transform"},
        {SENSOR "<f>9</f>" REST "2 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1" ENDING, "view a: rotation not orthonormal"},
        {"<document><chunk><transform><scale>0</scale></transform><sensors><sensor id=\"0\"><resolution width=\"8\" "
         "height=\"6\"/><calibration><f>9</f>" REST POSE ENDING, "view a: the scale of its chunk"},
        {"<document><chunk><cameras><camera label=\"a\" sensor_id=\"0\"><transform>" POSE ENDING,
         "view a: its sensor is not in"},
        {"<document><chunk><sensors><sensor id=\"0\"/></sensors><cameras><camera label=\"a\" sensor_id=\"0\">"
         "<transform>" POSE ENDING, "view a: its sensor has no calibration"},
        {"<document><chunk><sensors><sensor id=\"0\" type=\"spherical\"><resolution width=\"8\" height=\"6\"/>"
         "<calibration><f>9</f>" REST POSE ENDING, "view a: its sensor is neither a frame nor"},
        {"<document><chunk><sensors><sensor id=\"0\"><resolution width=\"8\"/>",
         "a resolution without width and height"},
        {"<document><chunk><sensors><sensor id=\"123456789012345678901234567890\"/>", "too long: id"},
        {SENSOR "<f>9</f></calibration></sensor></sensors><cameras><camera sensor_id=\"0\"><transform>" POSE
         "</transform></cameras>", "mismatched tag"},
    };
    for (size_t i = 0; i < sizeof faults / sizeof *faults; i++)
        check_fault("e/x.xml", faults[i][0], faults[i][1]);
    static char padded[5000];
    int size = sprintf(padded, SENSOR "<f>9</f>" REST "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1");
    memset(padded + size, ' ', 3000);
    strcpy(padded + size + 3000, "5" ENDING);
    check_fault("e/x.xml", padded, "not so many as there should be: transform");
    size = 0;
    for (int i = 0; i < 600; i++)
        size += sprintf(padded + size, "<a>");
    check_fault("e/x.xml", padded, "line 1: no element found");
    put_ppm("e/images/a.jpg", 8, 6, NULL);
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    const char *unnamed = SENSOR "<f>9</f></calibration></sensor></sensors><cameras><camera sensor_id=\"0\"><transform>"
                          POSE ENDING;
    put_file("e/x.xml", unnamed, strlen(unnamed));
    check_refused("e/x.xml", &options, FXS_ERR_FILE, "view 0: it names no photograph");
}
#endif

static void check_cut(const char *name)
{
    static char whole[1 << 16];
    char path[512];
    strcpy(path, in_folder(name));
    FILE *file = fopen(path, "rb");
    const size_t size = file ? fread(whole, 1, sizeof whole, file) : 0;
    CHECK(file && size > 500 && !fclose(file));
    for (size_t i = 0; i < size; i++) {
        fxs_view_list list = {.path = path, .message = &message};
        put_file(name, whole, i);
        const int error = fxs_view_list_read(&list);
        CHECK(!error ? list.count <= CAMERAS : error == FXS_ERR_FILE && message.text[0]);
        fxs_view_list_free(&list);
    }
    put_file(name, whole, size);
}

static void cut_short(void)
{
    write_csv(4);
    check_cut("e/cameras.csv");
    write_bundler(1);
    check_cut("e/bundle.out");
#ifdef FXS_WITH_EXPAT
    write_metashape("component", "frame", LENS);
    check_cut("e/cameras.xml");
#endif
}

static void tests(void)
{
    make_folder("e");
    make_folder("e/images");
    RUN(csv);
    RUN(bundler);
#ifdef FXS_WITH_EXPAT
    RUN(metashape);
    RUN(metashape_components);
#endif
    RUN(photographs);
    RUN(points);
    RUN(blocks);
#ifdef FXS_WITH_EXPAT
    RUN(on_earth);
#endif
    RUN(far_away);
    RUN(csv_faults);
    RUN(bundler_faults);
#ifdef FXS_WITH_EXPAT
    RUN(metashape_faults);
#endif
    RUN(cut_short);
    fxs_photos_free(&photos);
}

int main(void)
{
    return in_a_folder(tests);
}
