"""The client for programs with asyncio: the names of the synchronous client, and `await` for what waits.

::

    async with Morse() as simu:
        simu.robot.motion.publish({"v": 1.0, "w": 0.0})
        print(await simu.robot.pose.get())
"""

from __future__ import annotations

import asyncio
import contextlib
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

from pymorse.component import Component
from pymorse.failures import Failures
from pymorse.future import MorseFuture
from pymorse.messages import Messages

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable

    from pymorse.pymorse import Morse

#: calls that wait at the same time, besides services and messages, which need no thread
_WORKERS = 8
#: messages that wait for a slow `async for`; the oldest ones are dropped
_MOST_WAITING = 1000
#: s: interval at which a waiting `get` looks whether the simulation has ended
_LOOK = 0.5
#: methods that never wait
_AT_ONCE = frozenset(("cancel", "is_up"))


class AsyncMorse:
    """A simulation in a program with asyncio; what ``async with Morse()`` returns.

    All names are those of `Morse`: robots are attributes, methods are awaited.

    Args:
        morse: the connection.
    """

    def __init__(self, morse: Morse) -> None:
        self._morse = morse
        self._loop = asyncio.get_running_loop()
        self._components: dict[int, AsyncComponent] = {}
        self._pool = ThreadPoolExecutor(_WORKERS, thread_name_prefix="pymorse-await")

    def __getattr__(self, name: str) -> Any:
        return self._awaitable(getattr(self._morse, name))

    def __getitem__(self, name: str) -> AsyncComponent:
        """The robot of that name."""
        return self.wrap(self._morse[name])

    def wrap(self, component: Component) -> AsyncComponent:
        """The component of this client for one of the synchronous client, always the same."""
        return self._components.setdefault(id(component), AsyncComponent(self, component))

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *dir(self._morse)]

    def call(self, component: str, service: str, *args: object) -> asyncio.Future[Any]:
        """Call a service without waiting; to await the future waits, and to cancel it aborts the service."""
        return self._future(self._morse.call(component, service, *args))

    async def rpc(self, component: str, service: str, *args: object) -> Any:
        """Call a service and wait for its result; see `Morse.rpc`."""
        return await self.call(component, service, *args)

    def _awaitable(self, value: Any) -> Any:
        if isinstance(value, Component):
            return self.wrap(value)
        if isinstance(value, list) and value and isinstance(value[0], Component):
            return [self.wrap(one) for one in value]
        if not callable(value):
            return value

        async def wait(*args: Any, **options: Any) -> Any:
            args = tuple(_plain(one) for one in args)
            if value.__name__ == "exchange":
                return await self._exchange(*args, **options)
            if value.__name__ in _AT_ONCE:
                return value(*args, **options)
            return await self.run(lambda: value(*args, **options))

        wait.__name__, wait.__doc__ = value.__name__, value.__doc__
        return wait

    async def _exchange(self, commands: Any = None, read: Any = (), n: int = 1) -> dict[Any, Any]:
        """See `Morse.exchange`; components may be those of this client."""
        parts = list(read)
        given = {_plain(part): command for part, command in (commands or {}).items()}
        answer = await self.run(lambda: self._morse.exchange(given, [_plain(part) for part in parts], n))
        return {part: answer[_plain(part)] for part in parts}

    async def run(self, function: Callable[[], object]) -> Any:
        """Return the value of a function that waits; it runs in a thread."""
        return await self._loop.run_in_executor(self._pool, function)

    def _future(self, answer: MorseFuture) -> asyncio.Future[Any]:
        future: asyncio.Future[Any] = self._loop.create_future()

        def finish() -> None:
            if future.done():
                return
            error = answer.exception(0)
            if error is None:
                future.set_result(answer.result(0))
            else:
                future.set_exception(error)

        def abort(ended: asyncio.Future[object]) -> None:
            if ended.cancelled():
                answer.abandoned = True
                with contextlib.suppress(ConnectionError):
                    answer.cancel()

        future.add_done_callback(abort)
        # in the thread of the connection: the callbacks of MorseFuture have threads of their own
        super(MorseFuture, answer).add_done_callback(lambda _: self._soon(finish))
        return future

    def _soon(self, function: Callable[..., object], *args: object) -> None:
        with contextlib.suppress(RuntimeError):  # the loop has ended
            self._loop.call_soon_threadsafe(function, *args)

    async def close(self, cancel_async_services: bool = False, wait_publishers: bool = True) -> None:
        """Close all connections; see `Morse.close`."""
        await self.run(lambda: self._morse.close(cancel_async_services, wait_publishers))
        self._pool.shutdown(wait=False)


class AsyncComponent:
    """A robot, a sensor or an actuator.

    Parts are attributes. Services return futures: ``await simu.robot.motion.goto(1, 2)``. A sensor has ``await
    get(timeout)``, ``await last(n)``, ``subscribe(callback)``, ``unsubscribe(callback)`` and ``async for data in
    simu.robot.pose``; callbacks run in the loop and may be coroutine functions. An actuator has ``publish(data)``,
    which never waits and may be awaited.

    Args:
        simu: the simulation.
        component: the component of the synchronous client.
    """

    def __init__(self, simu: AsyncMorse, component: Component) -> None:
        self._simu, self._component = simu, component
        self._callbacks: dict[Any, Any] = {}
        self._failures = Failures(lambda: repr(component))

    def __getitem__(self, name: str) -> AsyncComponent:
        """The part of that name."""
        return self._simu.wrap(self._component[name])

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        component = self._component
        part = component._part(name)
        if part is not None:
            return self._simu.wrap(part)
        value = getattr(component, name)
        if name not in component._services:
            return value

        def call(*args: object) -> asyncio.Future[Any]:
            return self._simu._future(value(*args))

        call.__name__, call.__doc__ = name, value.__doc__
        return call

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *dir(self._component)]

    def __repr__(self) -> str:
        return repr(self._component)

    async def _messages(self) -> Messages:
        """The stream of the sensor, open."""
        _ = self._component.get  # the error of an actuator, or of a component without a stream
        stream = self._component._stream or await self._simu.run(lambda: self._component.stream)
        assert isinstance(stream, Messages)
        return stream

    async def get(self, timeout: float | None = None) -> Any:
        """Wait for the next message of the sensor; see `Messages.get`."""
        stream, loop = await self._messages(), self._simu._loop
        arrival: asyncio.Future[Any] = loop.create_future()

        def arrive(message: object) -> None:
            if not arrival.done():
                arrival.set_result(message)

        def take(message: object) -> None:
            self._simu._soon(arrive, message)

        stream.subscribe(take)
        end = None if timeout is None else loop.time() + timeout
        try:
            while not arrival.done():
                if not stream.is_up():
                    raise ConnectionError(f"{stream.peer} closed the stream: {stream.ending}")
                left = _LOOK if end is None else min(_LOOK, end - loop.time())
                if left <= 0.0:
                    return None
                await asyncio.wait((arrival,), timeout=left)
            return arrival.result()
        finally:
            with contextlib.suppress(ValueError):
                stream.unsubscribe(take)

    async def last(self, n: int = 1) -> Any:
        """The most recent message of the sensor; see `Messages.last`."""
        return (await self._messages()).last(n)

    def subscribe(self, callback: Callable[[Any], object], latest: bool = False) -> None:
        """Call a function, or a coroutine function, in the loop with every message of the sensor."""
        simu = self._simu

        def fail(error: BaseException) -> None:
            self._failures.add(take, error)

        def finish(task: asyncio.Task[object]) -> None:
            del self._callbacks[task]
            error = None if task.cancelled() else task.exception()
            if error is not None:
                fail(error)

        def run(message: object) -> None:
            try:
                result = callback(message)
            except Exception as error:
                fail(error)
                return
            if asyncio.iscoroutine(result):
                task = simu._loop.create_task(result)
                self._callbacks[task] = task
                task.add_done_callback(finish)

        def take(message: object) -> None:
            simu._soon(run, message)

        self._component.subscribe(take, latest)
        self._callbacks[callback] = take

    def unsubscribe(self, callback: Callable[[Any], object]) -> None:
        """Undo `subscribe`.

        Raises:
            ValueError: the callback was not subscribed.
        """
        if callback not in self._callbacks:
            raise ValueError(f"{callback!r} was not subscribed")
        take = self._callbacks.pop(callback)
        self._component.unsubscribe(take)
        self._failures.forget(take)

    def publish(self, msg: Any) -> asyncio.Future[None]:
        """Command the actuator; never waits."""
        self._component.publish(msg)
        done: asyncio.Future[None] = self._simu._loop.create_future()
        done.set_result(None)
        return done

    async def __aiter__(self) -> AsyncIterator[Any]:
        """Iterate over the messages of the sensor, until the simulation ends."""
        stream = await self._messages()
        queue: asyncio.Queue[Any] = asyncio.Queue(_MOST_WAITING)

        def arrive(message: object) -> None:
            if queue.full():
                queue.get_nowait()
            queue.put_nowait(message)

        def take(message: object) -> None:
            self._simu._soon(arrive, message)

        stream.subscribe(take)
        try:
            while stream.is_up() or not queue.empty():
                with contextlib.suppress(TimeoutError):
                    async with asyncio.timeout(_LOOK):
                        message = await queue.get()
                    yield message
        finally:
            with contextlib.suppress(ValueError):
                stream.unsubscribe(take)


def _plain(value: object) -> Any:
    """The component of the synchronous client; other values as they are."""
    return value._component if isinstance(value, AsyncComponent) else value
