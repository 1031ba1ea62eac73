"""How jupyter_client starts our kernels: one kernelspec, sockets in the kernel's own folder."""

from pathlib import Path
from subprocess import DEVNULL

from jupyter_client import AsyncKernelManager
from jupyter_client.kernelspec import KernelSpec, KernelSpecManager
from zmq.asyncio import Context

from grader.kernels.provisioner import NAME
from grader.sandbox.kernel_paths import KernelPaths


class OurKernelSpec(KernelSpecManager):
    """One kernel, with this process's interpreter: a student's kernelspecs are never looked up."""

    argv: tuple[str, ...] = ()
    metadata: dict = {}

    def get_kernel_spec(self, kernel_name: str) -> KernelSpec:
        """Return the kernelspec, whatever the name."""
        return KernelSpec(
            argv=list(self.argv),
            display_name='my_robot_basics',
            language='python',
            interrupt_mode='message',  # a signal sent from outside would end a sandbox
            metadata=self.metadata,
        )


def manager_of(paths: KernelPaths, context: Context) -> AsyncKernelManager:
    """Return the manager that starts, interrupts and ends the kernel with these paths."""
    specs = OurKernelSpec()
    specs.argv = tuple(paths.command())
    if paths.sandboxed:
        specs.metadata = {'kernel_provisioner': {'provisioner_name': NAME}}
    return AsyncKernelManager(
        context=context,
        kernel_spec_manager=specs,
        transport='ipc',
        ip=str(paths.sockets / 'zmq'),
        connection_file=str(paths.folder / 'connection.json'),
    )


async def launch(
    manager: AsyncKernelManager, paths: KernelPaths, room: str, environment: dict[str, str]
) -> None:
    """Start a kernel: in a sandbox, or with the grading user's rights."""
    if paths.sandboxed:
        await manager.start_kernel(paths=paths, room=room, env=environment)
        return
    manager.write_connection_file()
    paths.write_connection_file(Path(manager.connection_file))
    await manager.start_kernel(
        cwd=paths.folder / 'home' / 'work', env=environment, stdout=DEVNULL, stderr=DEVNULL
    )
