/* A small engine with a Gaussian splatting scene, on the engine's own VkDevice and swapchain, two frames in flight. The
 * engine draws a mesh, a ball; fixsplat draws the scene into the same image. The ball hides the Gaussians behind it,
 * and Gaussians in front cover the ball. A click prints the Gaussian under the pointer; a drag turns the camera;
 * Escape closes the window.
 *
 *     for kind in vert frag; do glslangValidator -V --vn glfw_$kind glfw.$kind -o glfw_$kind.h; done
 *     c++ -std=c++17 glfw.cpp -o glfw $(pkg-config --cflags --libs fixsplat glfw3 vulkan)
 *     ./glfw SCENE */
#include <cmath>

#include <fixsplat/renderer.h>
#include <fixsplat/vulkan.h>

#include "glfw_engine.hpp"

static const float near_plane = 0.2f;               /* fixsplat's own: distance at depth 1; depth 0 is infinity */
static double x, y, yaw, pitch = 0.3;               /* the pointer; the camera's direction, radians */
static int clicked[2] = {-1, -1};                   /* the pixel to pick */
static fxs_message why = {"usage: glfw SCENE", 0, {}};

static void check(int error)
{
    if (error < 0)
        throw std::runtime_error(why.text);
}

static void moved(GLFWwindow *window, double to_x, double to_y)
{
    if (glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_LEFT)) {
        yaw += 0.01 * (to_x - x);
        pitch = std::fmax(-1.5, std::fmin(pitch + 0.01 * (to_y - y), 1.5));
    }
    x = to_x;
    y = to_y;
}

/* Prints the Gaussian at pixel (px, py), or the ball if the ball is nearer. The ball is met at a
 * depth z with |z (u, v, 1) - (0, 0, away)| = radius. */
static void pick(fxs_renderer *picker, const fxs_request &request, const fxs_view &view, double away, double radius,
                 int px, int py)
{
    const double u = (px + 0.5 - view.cx) / view.fx, v = (py + 0.5 - view.cy) / view.fy, square = u * u + v * v + 1;
    const double root = away * away - square * (away * away - radius * radius);
    const double z = root < 0 ? INFINITY : (away - std::sqrt(root)) / square;
    fxs_pick_result at;
    const int found = fxs_renderer_pick(picker, &request, px, py, &at, &why);
    check(found);
    if (found && std::ldexp(at.depth_q32, -32) < z)
        printf("object %u, Gaussian %u at %.3f, %.3f, %.3f\n", at.id, at.gaussian, std::ldexp(at.position_q32[0], -32),
               std::ldexp(at.position_q32[1], -32), std::ldexp(at.position_q32[2], -32));
    else
        puts(root < 0 ? "nothing" : "the ball");
    fflush(stdout);
}

static fxs_vulkan_image describe(vk::Image image, vk::Format format, vk::ImageUsageFlags usage, vk::Extent2D size,
                                 vk::ImageLayout layout)
{
    return {image, VkFormat(format), VkImageUsageFlags(usage), size.width, size.height, 1, 0, 0, 0,
            VkImageLayout(layout), VkImageLayout(layout)};
}

static void run(GLFWwindow *window, const fxs_opened *opened)
{
    Engine engine(window);
    fxs_vulkan *vulkan;                                     /* draws on the engine's device */
    fxs_renderer *picker;                                   /* picks on the processor, which gives the same bytes */
    fxs_vulkan_options options;
    fxs_object object;
    fxs_request request;
    fxs_vulkan_options_init(&options);
    options.load = vkGetInstanceProcAddr;
    options.instance = *engine.instance;
    options.physical = engine.physical;
    options.device = *engine.device;
    options.queue = engine.queue;
    check(fxs_vulkan_create(&vulkan, &options, &why));
    check(fxs_vulkan_upload(vulkan, opened->scene, &why));
    check(fxs_renderer_create("cpu", nullptr, &picker, &why));
    fxs_object_init(&object, opened->scene);
    fxs_request_init(&request, &object, 1);
    const double *const low = opened->report->inner_low, *const high = opened->report->inner_high;
    const double middle[3] = {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2};
    const double away = 1.5 * (high[0] - low[0]), radius = away / 8;    /* distance of the camera; the ball's radius */
    const double up[3] = {0, -1, 0};                        /* y points down */
    while (!glfwWindowShouldClose(window) && !glfwGetKey(window, GLFW_KEY_ESCAPE)) {
        int width, height;
        glfwPollEvents();
        glfwGetFramebufferSize(window, &width, &height);
        if (!width || !height) {                            /* the window is an icon */
            glfwWaitEvents();
            continue;
        }
        const double eye[3] = {middle[0] - away * std::sin(yaw) * std::cos(pitch), middle[1] - away * std::sin(pitch),
                               middle[2] - away * std::cos(yaw) * std::cos(pitch)};
        const fxs_picture picture = {50, width, height};
        fxs_view view;
        check(fxs_view_look_at(&view, eye, middle, up, &picture, &why));
        check(fxs_camera_from_view(&request.cameras[0], &view, &why));
        if (clicked[0] >= 0)
            pick(picker, request, view, away, radius, clicked[0], clicked[1]);
        clicked[0] = -1;
        float to_clip[4][4] = {{}, {}, {}, {0, 0, near_plane, float(away)}};    /* of the ball, by columns */
        for (int i = 0; i < 3; i++) {
            to_clip[i][0] = float(radius * view.rotation[i] * 2 * view.fx / width);
            to_clip[i][1] = float(radius * view.rotation[3 + i] * 2 * view.fy / height);
            to_clip[i][3] = float(radius * view.rotation[6 + i]);
        }
        try {
            const vk::Extent2D size(width, height);
            const vk::CommandBuffer commands = engine.begin(size, to_clip);
            fxs_vulkan_target target = {};
            target.plane_0 = INFINITY;
            target.plane_1 = near_plane;
            target.backdrop = describe(engine.shown[engine.i].image, engine.format, engine.usage, size, engine.layout);
            target.colour = target.backdrop;                /* the image with the ball is read, then written */
            target.colour.after = VK_IMAGE_LAYOUT_PRESENT_SRC_KHR;
            target.occluder = describe(*engine.depth, engine.depth_format, engine.depth_usage, size,
                                       engine.depth_layout);
            check(fxs_vulkan_record(vulkan, &request, &target, commands, &why));
            engine.end();
        } catch (const vk::OutOfDateKHRError &) {
            engine.size = vk::Extent2D();                   /* the window has changed: makes a new swapchain */
        }
    }
    engine.device->waitIdle();
    fxs_renderer_destroy(picker);
    fxs_vulkan_destroy(vulkan);
}

int main(int argc, char **argv) try {
    fxs_opened *opened;
    check(argc == 2 ? fxs_open(argv[1], nullptr, &opened, &why) : FXS_ERR_ARGUMENT);
    glfwSetErrorCallback([](int, const char *text) { fprintf(stderr, "glfw: %s\n", text), exit(1); });
    glfwInit();
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    GLFWwindow *const window = glfwCreateWindow(640, 360, "A mesh in a scene", nullptr, nullptr);
    glfwSetCursorPosCallback(window, moved);
    glfwSetMouseButtonCallback(window, [](GLFWwindow *, int, int action, int) {
        if (action == GLFW_PRESS)
            clicked[0] = int(x), clicked[1] = int(y);
    });
    run(window, opened);
    glfwTerminate();
    fxs_close(opened);
    return 0;
} catch (const std::exception &error) {
    fprintf(stderr, "glfw: %s\n", error.what());
    return 1;
}
