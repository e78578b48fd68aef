/* The engine of glfw.cpp. It knows nothing of fixsplat: a VkDevice, a swapchain with a depth image, two frames in
 * flight, and a pipeline that draws a mesh, a ball of radius 1. Errors of Vulkan are exceptions. */
#include <vulkan/vulkan.hpp>
#include <GLFW/glfw3.h>
#include "glfw_vert.h"
#include "glfw_frag.h"

struct Engine {
    static constexpr auto format = vk::Format::eB8G8R8A8Unorm, depth_format = vk::Format::eD32Sfloat;
    static constexpr auto layout = vk::ImageLayout::eColorAttachmentOptimal;
    static constexpr auto depth_layout = vk::ImageLayout::eDepthStencilAttachmentOptimal;
    const vk::ImageUsageFlags usage = vk::ImageUsageFlagBits::eColorAttachment | vk::ImageUsageFlagBits::eTransferSrc |
                                      vk::ImageUsageFlagBits::eTransferDst;
    const vk::ImageUsageFlags depth_usage = vk::ImageUsageFlagBits::eDepthStencilAttachment |
                                            vk::ImageUsageFlagBits::eTransferSrc;
    const vk::ImageSubresourceRange colours{vk::ImageAspectFlagBits::eColor, 0, 1, 0, 1};
    const vk::ImageSubresourceRange depths{vk::ImageAspectFlagBits::eDepth, 0, 1, 0, 1};
    struct Frame { vk::UniqueCommandBuffer commands; vk::UniqueFence ended; vk::UniqueSemaphore acquired; };
    struct Shown { vk::Image image; vk::UniqueImageView view; vk::UniqueSemaphore drawn; };

    vk::UniqueInstance instance;
    vk::UniqueSurfaceKHR surface;
    vk::PhysicalDevice physical;
    vk::UniqueDevice device;
    vk::Queue queue;
    vk::UniqueCommandPool pool;
    Frame frames[2];
    vk::UniquePipelineLayout matrix;
    vk::UniquePipeline ball;
    vk::UniqueSwapchainKHR swapchain;
    std::vector<Shown> shown;
    vk::UniqueDeviceMemory memory;
    vk::UniqueImage depth;
    vk::UniqueImageView depth_view;
    vk::Extent2D size;
    uint32_t n = 0, i = 0;                                  /* the current frame, and its image of the swapchain */

    explicit Engine(GLFWwindow *window)
    {
        const vk::ApplicationInfo application("engine", 1, nullptr, 0, VK_API_VERSION_1_3);
        uint32_t count = 0;
        const char **const needed = glfwGetRequiredInstanceExtensions(&count), *const also = "VK_KHR_swapchain";
        instance = vk::createInstanceUnique({{}, &application, 0, nullptr, count, needed});
        VkSurfaceKHR made;
        vk::resultCheck(vk::Result(glfwCreateWindowSurface(*instance, window, nullptr, &made)), "no surface");
        surface = vk::UniqueSurfaceKHR(made, *instance);
        const auto all = instance->enumeratePhysicalDevices();
        if (all.empty())
            throw std::runtime_error("no device of Vulkan");
        physical = all[0];
        const float priority = 1;                           /* queue family 0 has graphics, compute and the window */
        const vk::DeviceQueueCreateInfo of_queue({}, 0, 1, &priority);
        const auto features = vk::PhysicalDeviceVulkan13Features().setDynamicRendering(true);
        device = physical.createDeviceUnique({{}, 1, &of_queue, 0, nullptr, 1, &also, nullptr, &features});
        queue = device->getQueue(0, 0);
        pool = device->createCommandPoolUnique({vk::CommandPoolCreateFlagBits::eResetCommandBuffer, 0});
        for (Frame &f : frames)
            f = {std::move(device->allocateCommandBuffersUnique({*pool, vk::CommandBufferLevel::ePrimary, 1})[0]),
                 device->createFenceUnique({vk::FenceCreateFlagBits::eSignaled}), device->createSemaphoreUnique({})};
        make_ball();
    }

    void make_ball()
    {
        const vk::PushConstantRange range(vk::ShaderStageFlagBits::eVertex, 0, 16 * sizeof(float));
        matrix = device->createPipelineLayoutUnique({{}, nullptr, range});
        const auto vertex = device->createShaderModuleUnique({{}, sizeof glfw_vert, glfw_vert});
        const auto fragment = device->createShaderModuleUnique({{}, sizeof glfw_frag, glfw_frag});
        const vk::PipelineShaderStageCreateInfo stages[] = {
            {{}, vk::ShaderStageFlagBits::eVertex, *vertex, "main"},
            {{}, vk::ShaderStageFlagBits::eFragment, *fragment, "main"}};
        const vk::PipelineVertexInputStateCreateInfo input;     /* none: the vertex shader makes the ball */
        const vk::PipelineInputAssemblyStateCreateInfo triangles({}, vk::PrimitiveTopology::eTriangleList);
        const vk::PipelineViewportStateCreateInfo viewports({}, 1, nullptr, 1, nullptr);
        const auto raster = vk::PipelineRasterizationStateCreateInfo().setLineWidth(1);
        const vk::PipelineMultisampleStateCreateInfo samples;
        const vk::PipelineDepthStencilStateCreateInfo nearest({}, true, true, vk::CompareOp::eGreater);
        const auto opaque = vk::PipelineColorBlendAttachmentState().setColorWriteMask(vk::ColorComponentFlags(15));
        const vk::PipelineColorBlendStateCreateInfo blending({}, false, {}, opaque);
        const vk::DynamicState states[] = {vk::DynamicState::eViewport, vk::DynamicState::eScissor};
        const vk::PipelineDynamicStateCreateInfo dynamic({}, states);
        const vk::PipelineRenderingCreateInfo formats(0, format, depth_format);
        ball = device->createGraphicsPipelineUnique(nullptr, {{}, stages, &input, &triangles, nullptr, &viewports,
            &raster, &samples, &nearest, &blending, &dynamic, *matrix, nullptr, 0, nullptr, 0, &formats}).value;
    }

    void resize(vk::Extent2D to)
    {
        device->waitIdle();
        const auto able = physical.getSurfaceCapabilitiesKHR(*surface);
        swapchain = device->createSwapchainKHRUnique({{}, *surface, able.minImageCount, format, {}, to, 1, usage, {},
            {}, able.currentTransform, vk::CompositeAlphaFlagBitsKHR::eOpaque, vk::PresentModeKHR::eFifo, true,
            *swapchain});
        shown.clear();
        for (const vk::Image one : device->getSwapchainImagesKHR(*swapchain)) {
            auto view = device->createImageViewUnique({{}, one, vk::ImageViewType::e2D, format, {}, colours});
            shown.push_back({one, std::move(view), device->createSemaphoreUnique({})});
        }
        depth = device->createImageUnique({{}, vk::ImageType::e2D, depth_format, vk::Extent3D(to, 1), 1, 1,
                                           vk::SampleCountFlagBits::e1, {}, depth_usage});
        const auto needs = device->getImageMemoryRequirements(*depth);
        uint32_t type = 0;                                  /* drivers list the fastest memory first */
        while (!(needs.memoryTypeBits >> type & 1))
            type++;
        memory = device->allocateMemoryUnique({needs.size, type});
        device->bindImageMemory(*depth, *memory, 0);
        depth_view = device->createImageViewUnique({{}, *depth, vk::ImageViewType::e2D, depth_format, {}, depths});
        size = to;
    }

    /* Begins a frame of a size: clears its image, and draws the ball by a matrix to clip space, given by columns. */
    vk::CommandBuffer begin(vk::Extent2D to, const float to_clip[4][4])
    {
        if (size != to)
            resize(to);
        (void)device->waitForFences(*frames[n].ended, true, UINT64_MAX);
        i = device->acquireNextImageKHR(*swapchain, UINT64_MAX, *frames[n].acquired).value;
        const vk::CommandBuffer commands = *frames[n].commands;
        const auto all = vk::PipelineStageFlagBits::eAllCommands;
        const vk::ImageMemoryBarrier fresh[] = {
            {{}, vk::AccessFlagBits::eColorAttachmentWrite, {}, layout, 0, 0, shown[i].image, colours},
            {{}, vk::AccessFlagBits::eDepthStencilAttachmentWrite, {}, depth_layout, 0, 0, *depth, depths}};
        const auto clear = vk::AttachmentLoadOp::eClear;
        const vk::RenderingAttachmentInfo colour_attachment(*shown[i].view, layout, {}, {}, {}, clear);
        const vk::RenderingAttachmentInfo depth_attachment(*depth_view, depth_layout, {}, {}, {}, clear);
        commands.begin(vk::CommandBufferBeginInfo());
        commands.pipelineBarrier(all, all, {}, {}, {}, fresh);
        commands.beginRendering({{}, {{}, size}, 1, 0, colour_attachment, &depth_attachment});
        commands.bindPipeline(vk::PipelineBindPoint::eGraphics, *ball);
        commands.setViewport(0, vk::Viewport(0, 0, float(size.width), float(size.height), 0, 1));
        commands.setScissor(0, vk::Rect2D({}, size));
        commands.pushConstants(*matrix, vk::ShaderStageFlagBits::eVertex, 0, 16 * sizeof(float), to_clip);
        commands.draw(96 * 48 * 6, 1, 0, 0);
        commands.endRendering();
        return commands;
    }

    /* Submits the frame, and shows its image, which is in the layout VK_IMAGE_LAYOUT_PRESENT_SRC_KHR. */
    void end()
    {
        const Frame &f = frames[n];
        const vk::PipelineStageFlags all = vk::PipelineStageFlagBits::eAllCommands;
        f.commands->end();
        device->resetFences(*f.ended);
        queue.submit(vk::SubmitInfo(*f.acquired, all, *f.commands, *shown[i].drawn), *f.ended);
        n ^= 1;
        (void)queue.presentKHR({*shown[i].drawn, *swapchain, i});
    }
};
